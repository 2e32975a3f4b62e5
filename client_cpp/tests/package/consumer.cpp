// Uses the installed library: nobody listens on port 1, and the client says so.
#include <mane/client.h>

#include <cstdio>

int main() {
  mane::ClientOptions options;
  options.address = "127.0.0.1:1";
  options.connect_timeout = std::chrono::milliseconds(300);
  const auto client = mane::Client::Connect(options);
  if (client || client.error().code != mane::ErrorCode::kUnavailable) return 1;
  std::printf("%s\n", client.error().message.c_str());
  return 0;
}
