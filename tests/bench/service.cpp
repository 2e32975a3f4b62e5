// Load generator of the service benchmark: one measurement against a running daemon, printed as one
// JSON object. service.py starts the daemon and puts the measurements together.
//
// Poses follow a fixed schedule and carry the scheduled time, so that a late generator or a late
// server shows as age and never slows the load down.

#include <fmt/format.h>
#include <mane/client.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;  // NOLINT(google-build-using-namespace)

constexpr double kRate = 60;   // Poses and frames a second.
constexpr double kWarmUp = 2;  // Not measured at the start of a stream [s].
constexpr auto kPoll = 500us;  // How often the game loop looks for frames.
constexpr auto kOpenTimeout = 30s;

// The value, or an exception that ends the program with the error's sentence.
template <typename T>
T Must(mane::Result<T> result) {
  if (!result) throw std::runtime_error(result.error().message);
  return *std::move(result);
}
void Must(const mane::Result<void>& result) {
  if (!result) throw std::runtime_error(result.error().message);
}

double Now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

// A lively head: turns by 0.6 rad at 1 Hz and bobs by 3 cm at 2 Hz.
mane::Pose PoseAt(double time) {
  const double yaw = 0.6 * std::sin(2 * M_PI * time);
  return {{0, 0.03 * std::sin(4 * M_PI * time), 0}, {0, std::sin(yaw / 2), 0, std::cos(yaw / 2)}};
}

struct Settings {
  std::string address;
  std::string groom = "bench";
  unsigned guides = 100;
  int heads = 8;
  double seconds = 60;
  double read_rate = 0;  // Frames that a slow reader takes a second.
};

mane::Client Connect(const Settings& settings) {
  mane::ClientOptions options;
  options.address = settings.address;
  return Must(mane::Client::Connect(options));
}

mane::HeadOptions HeadOf(const Settings& settings, mane::Pacing pacing) {
  mane::HeadOptions options;
  options.groom = "grooms/" + settings.groom;
  options.pacing = pacing;
  options.rate_hz = pacing == mane::Pacing::kRealtime ? kRate : 0;
  options.initial_pose = PoseAt(0);
  return options;
}

// The q-quantile of `values`, which it sorts.
double Quantile(std::vector<double>& values, double q) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(q * static_cast<double>(values.size() - 1))];
}

// One head of a game: sends its poses when they are due and looks at new frames when it reads.
class Player {
 public:
  Player(mane::Head head, double start, double read_interval)
      : head_(std::move(head)), start_(start), read_interval_(read_interval), next_read_(start) {}

  void Tick(double now) {
    const double due = start_ + static_cast<double>(poses_) / kRate;
    if (now >= due) {
      Must(head_.PushPose(due, PoseAt(due - start_)));
      ++poses_;
    }
    if (now < next_read_) return;
    next_read_ += read_interval_;
    const auto frame = head_.NewestFrame();
    if (!frame || frame->index == last_index_) return;
    last_index_ = frame->index;
    if (now < start_ + kWarmUp) {
      first_index_ = frame->index;
      return;
    }
    ages_ms.push_back((now - frame->newest_pose_time_s) * 1e3);
    steps_ms.push_back(frame->step_ms);
    repaired += frame->repaired_guides;
  }

  [[nodiscard]] uint64_t frames_made() const { return last_index_ - first_index_; }
  [[nodiscard]] mane::HeadStatus Status() const { return head_.Status(); }

  std::vector<double> ages_ms;  // Of every new frame, from its newest pose to its reading [ms].
  std::vector<double> steps_ms;
  uint64_t repaired = 0;

 private:
  mane::Head head_;
  double start_, read_interval_, next_read_;
  uint64_t poses_ = 0, last_index_ = 0, first_index_ = 0;
};

// Plays `settings.heads` heads in real time from one loop, as a game does.
std::string Play(const Settings& settings) {
  mane::Client client = Connect(settings);
  std::vector<mane::Head> heads;
  for (int i = 0; i < settings.heads; ++i) {
    heads.push_back(client.OpenHead(HeadOf(settings, mane::Pacing::kRealtime)));
  }
  for (mane::Head& head : heads) Must(head.WaitUntilStreaming(kOpenTimeout));

  const double start = Now() + 0.01;
  const double read_interval = settings.read_rate > 0 ? 1 / settings.read_rate : 0;
  std::vector<Player> players;
  for (int i = 0; i < settings.heads; ++i) {
    players.emplace_back(std::move(heads[i]), start + i / (kRate * settings.heads), read_interval);
  }
  const double end = start + kWarmUp + settings.seconds;
  auto wake = Clock::now();
  for (double now = Now(); now < end; now = Now()) {
    for (Player& player : players) player.Tick(now);
    wake = std::max(wake + kPoll, Clock::now());
    std::this_thread::sleep_until(wake);
  }

  std::vector<double> ages, steps;
  uint64_t missed = 0, frames_made = 0, repaired = 0;
  for (const Player& player : players) {
    ages.insert(ages.end(), player.ages_ms.begin(), player.ages_ms.end());
    steps.insert(steps.end(), player.steps_ms.begin(), player.steps_ms.end());
    missed += player.Status().missed_deadlines;
    frames_made += player.frames_made();
    repaired += player.repaired;
  }
  return fmt::format(
      R"({{"seconds": {}, "frames_seen": {}, "frames_made": {}, "frames_due": {:.0f}, )"
      R"("missed_deadlines": {}, "repaired_guides": {}, "age_p50_ms": {:.2f}, )"
      R"("age_p99_ms": {:.2f}, "age_max_ms": {:.2f}, "step_p50_ms": {:.3f}, "step_p99_ms": {:.3f}}})",
      settings.seconds, ages.size(), frames_made, settings.heads * settings.seconds * kRate, missed,
      repaired, Quantile(ages, 0.5), Quantile(ages, 0.99), Quantile(ages, 1), Quantile(steps, 0.5),
      Quantile(steps, 0.99));
}

std::string Create(const Settings& settings) {
  mane::GroomUpload upload;
  upload.groom_id = settings.groom;
  upload.scalp = mane::EllipsoidScalp{{0, 0, 0}, {0.08, 0.11, 0.095}, {0, 1, 0}, 1.5};
  mane::GuideGeneration generation;
  generation.hair_type = mane::HairType::kCaucasianWavy;
  generation.guide_count = settings.guides;
  generation.length_m = 0.2;
  generation.element_count = 5;
  generation.seed = 1;
  upload.guides = generation;
  mane::Client client = Connect(settings);
  const double start = Now();
  const mane::GroomInfo info = Must(client.CreateGroom(upload));
  return fmt::format(R"({{"name": "{}", "guides": {}, "elements": {}, "create_ms": {:.2f}}})",
                     info.name, info.guide_count, info.element_count, (Now() - start) * 1e3);
}

// Times of opening heads one after the other, the first one of them cold.
std::string Open(const Settings& settings) {
  mane::Client client = Connect(settings);
  std::vector<double> times;
  for (int i = 0; i < settings.heads; ++i) {
    const double start = Now();
    mane::Head head = client.OpenHead(HeadOf(settings, mane::Pacing::kLockstep));
    Must(head.WaitUntilStreaming(kOpenTimeout));
    times.push_back((Now() - start) * 1e3);
    head.Close();
  }
  const double first = times.front();
  times.erase(times.begin());
  return fmt::format(
      R"({{"first_ms": {:.2f}, "others": {}, "others_p50_ms": {:.2f}, "others_max_ms": {:.2f}}})",
      first, times.size(), Quantile(times, 0.5), Quantile(times, 1));
}

std::string Lockstep(const Settings& settings) {
  mane::Client client = Connect(settings);
  mane::Head head = client.OpenHead(HeadOf(settings, mane::Pacing::kLockstep));
  Must(head.WaitUntilStreaming(kOpenTimeout));
  const int steps = static_cast<int>(settings.seconds * kRate);
  const double start = Now();
  for (int i = 1; i <= steps; ++i) Must(head.Step(i / kRate, PoseAt(i / kRate)));
  const double took = Now() - start;
  return fmt::format(
      R"({{"simulated_s": {}, "took_s": {:.4f}, "times_real_time": {:.2f}, "ms_per_step": {:.4f}}})",
      settings.seconds, took, settings.seconds / took, took / steps * 1e3);
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  CLI::App app{"Measures one thing of a running maned and prints it as JSON."};
  app.require_subcommand(1);
  app.add_option("--server", settings.address, "host:port of the daemon")->required();
  app.add_option("--groom", settings.groom, "Name of the groom");
  app.add_option("--guides", settings.guides, "create: guides of the groom");
  app.add_option("--heads", settings.heads, "play, open: how many")->check(CLI::Range(1, 10'000));
  app.add_option("--seconds", settings.seconds, "play, lockstep: how long, after the warm-up");
  app.add_option("--read-rate", settings.read_rate, "play: frames read a second; 0 reads each");
  app.add_subcommand("create", "Make a groom")->fallthrough();
  app.add_subcommand("play", "Heads in real time")->fallthrough();
  app.add_subcommand("open", "Open heads one after the other")->fallthrough();
  app.add_subcommand("lockstep", "One head as fast as it goes")->fallthrough();
  CLI11_PARSE(app, argc, argv);
  try {
    const std::string what = app.get_subcommands().front()->get_name();
    const std::string result = what == "create" ? Create(settings)
                               : what == "play" ? Play(settings)
                               : what == "open" ? Open(settings)
                                                : Lockstep(settings);
    fmt::print("{}\n", result);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "service_load: {}\n", error.what());
    return 1;
  }
}
