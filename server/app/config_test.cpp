// Properties of the daemon's configuration:
//   precedence   a flag wins over the environment, that over the file, that over the default
//   completeness every setting works from each of the three sources
//   refusal      a bad value names its source, the value and what is allowed
//   exposure     off loopback only with TLS and a token, or by explicit choice

#include "app/config.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "app/settings.h"

namespace mane::app {
namespace {

class ConfigTest : public ::testing::Test {
 protected:
  // `arguments` without the program's name.
  Result<Invocation> Read(std::vector<const char*> arguments) {
    arguments.insert(arguments.begin(), "maned");
    return ReadInvocation(arguments, [&](const std::string& name) -> std::optional<std::string> {
      const auto found = environment_.find(name);
      return found == environment_.end() ? std::nullopt : std::optional(found->second);
    });
  }

  std::string Refusal(const std::vector<const char*>& arguments) {
    const Result<Invocation> read = Read(arguments);
    return read ? "accepted" : read.error().message;
  }

  // Makes a configuration file for MANE_CONFIG.
  void UseFile(const std::string& text) {
    const std::filesystem::path path =
        std::filesystem::path(::testing::TempDir()) /
        (std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()) + ".toml");
    std::ofstream(path) << text;
    environment_["MANE_CONFIG"] = path.string();
  }

  std::map<std::string, std::string> environment_;
};

// A valid value that is not the default.
std::string Another(const Setting& setting) {
  if (setting.is_switch()) return "true";
  if (setting.name == "listen") return "127.0.0.1:0";
  if (setting.name == "log-level") return "debug";
  return setting.high > 0 ? fmt::format("{:.0f}", setting.high) : "some-name";
}

// tls-cert, tls-key and token-file come together.
bool NeedsOthers(const Setting& setting) {
  return setting.name.starts_with("tls-") || setting.name == "token-file";
}

TEST_F(ConfigTest, DefaultsAreValid) {
  const Result<Invocation> read = Read({});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->action, Invocation::Action::kServe);
  EXPECT_EQ(Describe(read->options), Describe(Options()));
}

TEST_F(ConfigTest, EverySettingComesFromFlagEnvironmentAndFile) {
  for (const Setting& setting : Settings()) {
    SCOPED_TRACE(setting.name);
    if (NeedsOthers(setting)) continue;
    const std::string value = Another(setting);
    ASSERT_NE(setting.Format(Options()), value);

    const std::string flag = "--" + std::string(setting.name);
    const auto by_flag =
        setting.is_switch() ? Read({flag.c_str()}) : Read({flag.c_str(), value.c_str()});
    ASSERT_TRUE(by_flag) << by_flag.error().message;
    EXPECT_EQ(setting.Format(by_flag->options), value);

    environment_ = {{setting.EnvironmentName(), value}};
    const auto by_environment = Read({});
    ASSERT_TRUE(by_environment) << by_environment.error().message;
    EXPECT_EQ(setting.Format(by_environment->options), value);

    environment_.clear();
    const bool bare = setting.high > 0 || setting.is_switch();
    UseFile(fmt::format(fmt::runtime(bare ? "{} = {}\n" : "{} = '{}'\n"), setting.name, value));
    const auto by_file = Read({});
    ASSERT_TRUE(by_file) << by_file.error().message;
    EXPECT_EQ(setting.Format(by_file->options), value);
    environment_.clear();
  }
}

TEST_F(ConfigTest, FlagWinsOverEnvironmentOverFile) {
  UseFile("max-heads = 3\nworkers = 3\ndrain-grace-s = 0.25\n");
  environment_["MANE_MAX_HEADS"] = "2";
  environment_["MANE_WORKERS"] = "2";
  const auto read = Read({"--max-heads", "1"});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->options.max_heads, 1);
  EXPECT_EQ(read->options.workers, 2);
  EXPECT_EQ(read->options.drain_grace_s, 0.25);
}

TEST_F(ConfigTest, TheConfigFlagWinsOverItsVariable) {
  UseFile("workers = 3\n");
  const std::string path = environment_["MANE_CONFIG"];
  environment_["MANE_CONFIG"] = "/nowhere/at/all.toml";
  const auto read = Read({"--config", path.c_str()});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->options.workers, 3);
}

TEST_F(ConfigTest, ABadValueNamesSourceValueAndRange) {
  EXPECT_EQ(Refusal({"--workers", "many"}),
            "--workers is 'many'; it must be a whole number from 0 to 256");
  EXPECT_EQ(Refusal({"--workers", "2.5"}),
            "--workers is '2.5'; it must be a whole number from 0 to 256");
  EXPECT_EQ(Refusal({"--workers", "257"}),
            "workers is 257; it must be a whole number from 0 to 256");
  EXPECT_EQ(Refusal({"--drain-grace-s", "nan"}),
            "drain-grace-s is nan; it must be a number from 0 to 600");
  environment_["MANE_MAX_HEADS"] = "";
  EXPECT_EQ(Refusal({}), "MANE_MAX_HEADS is ''; it must be a whole number from 1 to 100000");
  environment_.clear();
  UseFile("max-heads = true\n");
  EXPECT_EQ(Refusal({}), environment_["MANE_CONFIG"] +
                             ": max-heads is 'true'; it must be a whole number from 1 to 100000");
}

TEST_F(ConfigTest, EveryNumberHasARange) {
  for (const Setting& setting : Settings()) {
    if (setting.high == 0) continue;
    SCOPED_TRACE(setting.name);
    const std::string flag = "--" + std::string(setting.name);
    EXPECT_TRUE(Read({flag.c_str(), fmt::format("{:.0f}", setting.high).c_str()}));
    EXPECT_FALSE(Read({flag.c_str(), fmt::format("{:.0f}", setting.high + 1).c_str()}));
    EXPECT_FALSE(Read({flag.c_str(), fmt::format("{:.0f}", setting.low - 1).c_str()}));
  }
}

TEST_F(ConfigTest, UnknownFlagsAndKeysAreRefused) {
  EXPECT_NE(Refusal({"--wrokers", "2"}).find("--wrokers"), std::string::npos);
  EXPECT_NE(Refusal({"serve"}).find("serve"), std::string::npos);
  UseFile("wrokers = 2\n");
  EXPECT_NE(Refusal({}).find("'wrokers' is no setting"), std::string::npos);
}

TEST_F(ConfigTest, AFileThatCannotBeReadOrParsedIsNamed) {
  EXPECT_EQ(Refusal({"--config", "/nowhere/at/all.toml"}), "/nowhere/at/all.toml cannot be read");
  UseFile("workers = 2\nmax-heads == 3\n");
  EXPECT_NE(Refusal({}).find("line 2"), std::string::npos) << Refusal({});
  UseFile("workers = [1, 2]\n");
  EXPECT_NE(Refusal({}).find("workers must be a string, number or boolean"), std::string::npos);
}

TEST_F(ConfigTest, AListenAddressIsHostAndPort) {
  for (const char* listen : {"", "7420", ":7420", "127.0.0.1", "127.0.0.1:", "127.0.0.1:70000",
                             "127.0.0.1:-1", "127.0.0.1:74x", "localhost:http"}) {
    EXPECT_NE(Refusal({"--listen", listen}).find("must be host:port"), std::string::npos) << listen;
  }
  for (const char* listen : {"127.0.0.1:0", "localhost:7420", "[::1]:65535", "127.1.2.3:1"}) {
    EXPECT_TRUE(Read({"--listen", listen})) << listen;
  }
}

TEST_F(ConfigTest, OffLoopbackWantsTlsAndTokenOrAnExplicitChoice) {
  for (const char* listen : {"0.0.0.0:1", "[::]:1", "192.168.1.5:1", "example.org:1",
                             "127.0.0.1.example.org:1", "127.evil:1", "localhost.example.org:1"}) {
    SCOPED_TRACE(listen);
    EXPECT_NE(Refusal({"--listen", listen}).find("other machines can reach"), std::string::npos);
    EXPECT_FALSE(Read({"--listen", listen, "--tls-cert", "c", "--tls-key", "k"}));
    EXPECT_TRUE(
        Read({"--listen", listen, "--tls-cert", "c", "--tls-key", "k", "--token-file", "t"}));
    EXPECT_TRUE(Read({"--listen", listen, "--insecure-non-loopback"}));
  }
}

TEST_F(ConfigTest, CertificateAndKeyComeTogether) {
  EXPECT_EQ(Refusal({"--tls-cert", "c"}), "tls-cert is set without tls-key; TLS needs both");
  EXPECT_EQ(Refusal({"--tls-key", "k"}), "tls-key is set without tls-cert; TLS needs both");
  EXPECT_TRUE(Read({"--tls-cert", "c", "--tls-key", "k"}));
}

TEST_F(ConfigTest, ATokenNeedsTls) {
  EXPECT_NE(Refusal({"--token-file", "t"}).find("token-file is set without tls-cert"),
            std::string::npos);
  EXPECT_TRUE(Read({"--tls-cert", "c", "--tls-key", "k", "--token-file", "t"}));
}

TEST_F(ConfigTest, HelpNamesEverySettingAndItsVariable) {
  const auto read = Read({"--help"});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->action, Invocation::Action::kPrint);
  for (const Setting& setting : Settings()) {
    EXPECT_NE(read->text.find("--" + std::string(setting.name)), std::string::npos) << setting.name;
    EXPECT_NE(read->text.find(setting.EnvironmentName()), std::string::npos) << setting.name;
  }
}

TEST_F(ConfigTest, VersionIsPrinted) {
  const auto read = Read({"--version"});
  ASSERT_TRUE(read);
  EXPECT_EQ(read->action, Invocation::Action::kPrint);
  EXPECT_EQ(read->text, "maned " MANE_VERSION "\n");
}

TEST_F(ConfigTest, AHealthCheckNeedsNoSecretsOffLoopback) {
  const auto read = Read({"--health-check", "--listen", "0.0.0.0:7420"});
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->action, Invocation::Action::kCheckHealth);
  EXPECT_EQ(read->options.listen, "0.0.0.0:7420");
}

}  // namespace
}  // namespace mane::app
