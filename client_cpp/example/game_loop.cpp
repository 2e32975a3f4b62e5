// A game loop with hair: opens a head on a groom, nods it with a formula, takes the newest frame
// each tick, and prints how old the frames were.
//
//   game_loop --groom grooms/demo [--address 127.0.0.1:7420] [--hz 60] [--seconds 10]
//
// Without --groom it uploads one guide strand first and deletes it at the end.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "mane/client.h"

namespace {

using Clock = std::chrono::steady_clock;

struct Arguments {
  std::string address = "127.0.0.1:7420";
  std::string groom;
  double hz = 60;
  double seconds = 10;
};

bool Parse(int argc, char** argv, Arguments& arguments) {
  for (int i = 1; i + 1 < argc; i += 2) {
    const std::string name = argv[i];
    const char* value = argv[i + 1];
    if (name == "--address") {
      arguments.address = value;
    } else if (name == "--groom") {
      arguments.groom = value;
    } else if (name == "--hz") {
      arguments.hz = std::atof(value);
    } else if (name == "--seconds") {
      arguments.seconds = std::atof(value);
    } else {
      return false;
    }
  }
  return argc % 2 == 1 && arguments.hz >= 1 && arguments.hz <= 1000 && arguments.seconds > 0;
}

int Fail(const char* what, const mane::Error& error) {
  std::fprintf(stderr, "%s: %s %s\n", what, error.field.c_str(), error.message.c_str());
  return 1;
}

// A wavy strand of 20 cm that hangs from the side of the head.
mane::GroomUpload OneStrand() {
  mane::Guide guide;
  guide.root_position = {0.08, 0.1, 0};
  guide.length_m = 0.2;
  guide.element_count = 5;
  guide.radius_1_m = 50e-6;
  guide.radius_2_m = 40e-6;
  guide.young_modulus_pa = 1e9;
  guide.poisson_ratio = 0.48;
  guide.density_kg_m3 = 1300;
  guide.internal_friction = 5e-11;
  guide.air_drag = 5e-6;
  guide.natural_curvature_1 = {60};
  guide.natural_twist = {20};
  mane::GroomUpload upload;
  upload.display_name = "game_loop's strand";
  upload.guides = std::vector{guide};
  return upload;
}

// Nods by 0.4 rad and walks 5 cm to and fro.
mane::Pose PoseAt(double t) {
  const double nod = 0.4 * std::sin(2 * std::numbers::pi * 1.2 * t);
  mane::Pose pose;
  pose.position = {0.05 * std::sin(2 * std::numbers::pi * 0.7 * t), 1.7, 0};
  pose.orientation = {std::sin(nod / 2), 0, 0, std::cos(nod / 2)};
  return pose;
}

void PrintAges(std::vector<double> ages_ms, const mane::HeadStatus& status, long ticks) {
  if (ages_ms.empty()) {
    std::printf("no frame in %ld ticks\n", ticks);
    return;
  }
  std::sort(ages_ms.begin(), ages_ms.end());
  const auto at = [&](double part) {
    return ages_ms[static_cast<size_t>(part * static_cast<double>(ages_ms.size() - 1))];
  };
  std::printf("%zu frames in %ld ticks; age of a frame's newest pose when the game took it:\n",
              ages_ms.size(), ticks);
  std::printf("  p50 %.2f ms   p90 %.2f ms   p99 %.2f ms   worst %.2f ms\n", at(0.5), at(0.9),
              at(0.99), at(1));
  std::printf("resumed %u times, opened anew %u times, %llu missed deadlines\n", status.resumes,
              status.reopenings, static_cast<unsigned long long>(status.missed_deadlines));
}

// The loop itself. Nothing in it waits for the network.
int Play(mane::Head& head, const Arguments& arguments) {
  const auto tick = std::chrono::duration<double>(1 / arguments.hz);
  const auto start = Clock::now();
  const auto seconds_now = [&] {
    return std::chrono::duration<double>(Clock::now() - start).count();
  };
  std::vector<double> ages_ms;
  std::uint64_t shown = 0;
  long ticks = 0;
  for (;; ++ticks) {
    const double t = seconds_now();
    if (t >= arguments.seconds) break;
    if (auto pushed = head.PushPose(t, PoseAt(t)); !pushed) return Fail("pose", pushed.error());
    const auto frame = head.NewestFrame();
    if (frame && frame->index != shown) {
      shown = frame->index;
      ages_ms.push_back(1000 * (seconds_now() - frame->newest_pose_time_s));
      // Here a game would hand frame->positions to its renderer.
    }
    std::this_thread::sleep_until(start + (ticks + 1) * tick);
  }
  PrintAges(std::move(ages_ms), head.Status(), ticks);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (!Parse(argc, argv, arguments)) {
    std::fprintf(stderr,
                 "usage: %s [--groom grooms/NAME] [--address HOST:PORT] [--hz 1..1000] "
                 "[--seconds S]\n",
                 argv[0]);
    return 2;
  }
  auto client = mane::Client::Connect({.address = arguments.address});
  if (!client) return Fail("connect", client.error());

  const bool own_groom = arguments.groom.empty();
  if (own_groom) {
    auto groom = client->CreateGroom(OneStrand());
    if (!groom) return Fail("groom", groom.error());
    arguments.groom = groom->name;
  }
  mane::HeadOptions options;
  options.groom = arguments.groom;
  options.rate_hz = std::min(arguments.hz, 240.0);
  options.initial_pose = PoseAt(0);
  mane::Head head = client->OpenHead(options);
  auto open = head.WaitUntilStreaming(std::chrono::seconds(5));
  const int status = open ? Play(head, arguments) : Fail("open", open.error());
  head.Close();
  if (own_groom) {
    if (auto gone = client->DeleteGroom(arguments.groom); !gone) return Fail("clean", gone.error());
  }
  return status;
}
