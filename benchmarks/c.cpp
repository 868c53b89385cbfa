// What the C interface costs: a frame of 100 characters, stepped and read, through it and through the C++
// that it wraps.
//   bench_c [--json] [--rounds 15]
// Untrained models of full width (k = 256, 22 joints) of texts and of classes, each in a file that both sides
// load. Both write local rotations and positions as floats into one array. They take turns frame by frame.
// Printed are medians over rounds of 30 frames, a second of classes, and the median of the rounds' ratios.
#include <motiongan.h>
#include <unistd.h>

#include <filesystem>
#include <motiongan/data/action_dataset.hpp>
#include <motiongan/data/dataset.hpp>
#include <motiongan/procedural/procedural.hpp>
#include <motiongan/sample/character_stream.hpp>

#include "steps.hpp"

using namespace motiongan;

namespace {

constexpr std::size_t characters = 100, frames = 30;

void need(motiongan_status status) { require(status == MOTIONGAN_OK, motiongan_last_error()); }

/// Where a frame of all characters is written: rotations, then positions.
struct Frame {
  explicit Frame(std::size_t joint_count) : joints(joint_count), values(characters * joint_count * 7) {}
  float* positions() { return &values[characters * joints * 4]; }
  std::size_t joints;
  std::vector<float> values;
};

class Cpp {
 public:
  template <class Model>
  Cpp(const Model& model, const motion::Motion* prior) : stream_(model), frame_(stream_.skeleton().size()) {
    std::vector<CharacterStart> starts;
    for (std::uint32_t i = 0; i < characters; ++i)
      starts.push_back({.prompt = "walk", .sample = i, .prior = prior});
    ids_ = stream_.add(starts);
  }
  void operator()() {
    stream_.step();
    float *rotation = frame_.values.data(), *position = frame_.positions();
    for (const CharacterStream::Id id : ids_) {
      for (const motion::Quat& q : stream_.rotations(id))
        for (const double v : {q.x, q.y, q.z, q.w}) *rotation++ = static_cast<float>(v);
      for (const motion::Vec3& p : stream_.positions(id))
        for (const double v : p) *position++ = static_cast<float>(v);
    }
  }
  const std::vector<float>& values() const { return frame_.values; }

 private:
  CharacterStream stream_;
  Frame frame_;
  std::vector<CharacterStream::Id> ids_;
};

class C {
 public:
  C(const std::string& file, const std::string& prior, std::size_t joints) : frame_(joints) {
    need(motiongan_model_open(file.c_str(), nullptr, &model_));
    motiongan_clip clip = 0;
    if (!prior.empty()) need(motiongan_clip_read(prior.c_str(), &clip));
    need(motiongan_stream_create(model_, &stream_));
    std::vector<motiongan_start> starts(characters);
    for (std::uint32_t i = 0; i < characters; ++i)
      starts[i] = {
          .prompt = "walk", .seed = 1, .prior = clip, .x = 0, .z = 0, .yaw = 0, .sample = i, .placed = 0};
    std::vector<std::uint64_t> ids(characters);
    need(motiongan_stream_add(stream_, starts.data(), characters, ids.data()));
    if (clip != 0) need(motiongan_close(clip));
  }
  C(const C&) = delete;
  C& operator=(const C&) = delete;
  ~C() {
    motiongan_close(stream_);
    motiongan_close(model_);
  }
  void operator()() {
    need(motiongan_stream_step(stream_));
    need(motiongan_stream_get(stream_, nullptr, characters, MOTIONGAN_LOCAL_ROTATIONS, frame_.values.data(),
                              4 * characters * frame_.joints));
    need(motiongan_stream_get(stream_, nullptr, characters, MOTIONGAN_LOCAL_POSITIONS, frame_.positions(),
                              3 * characters * frame_.joints));
  }
  const std::vector<float>& values() const { return frame_.values; }

 private:
  motiongan_model model_ = 0;
  motiongan_stream stream_ = 0;
  Frame frame_;
};

/// Seconds that one frame takes.
template <class Side>
double frame_of(Side& side) {
  const double start = bench::seconds();
  side();
  return bench::seconds() - start;
}

void compare(const char* name, Cpp& cpp, C& c, std::size_t rounds, bool json) {
  std::vector<double> by_cpp, by_c, ratios;
  for (std::size_t round = 0; round < rounds + 1; ++round) {
    double times[2] = {0, 0};  // of a second of motion, in milliseconds per frame
    for (std::size_t f = 0; f < frames; ++f)
      for (const bool c_now : {round % 2 == 0, round % 2 != 0})
        times[c_now] += 1e3 / frames * (c_now ? frame_of(c) : frame_of(cpp));
    require(cpp.values() == c.values(), name, ": C and C++ make different motion");
    if (round == 0) continue;  // the first one builds kernels
    by_cpp.push_back(times[0]), by_c.push_back(times[1]), ratios.push_back(times[1] / times[0]);
  }
  const double cpp_ms = bench::median(by_cpp), c_ms = bench::median(by_c), ratio = bench::median(ratios);
  if (json)
    std::printf("%s\n",
                nlohmann::ordered_json{{"name", name}, {"cpp_ms", cpp_ms}, {"c_ms", c_ms}, {"ratio", ratio}}
                    .dump()
                    .c_str());
  else
    std::printf("%-8s C++ %.3f ms a frame, C %.3f ms, %+.1f%%\n", name, cpp_ms, c_ms, 100 * (ratio - 1));
}

int run(std::size_t rounds, bool json) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / concat("motiongan-bench-c-", ::getpid());
  std::filesystem::create_directories(folder);
  const std::string texts_file = (folder / "texts.safetensors").string(),
                    classes_file = (folder / "classes.safetensors").string(),
                    prior_file = (folder / "prior.bvh").string();
  const Context context;
  auto clips = motion::procedural_motions({.clips = 17, .seconds = 4, .rate = 30});
  motion::write_bvh(prior_file, clips[0].motion);
  Dvgan texts(context, motion::Dataset::from_motions(clips, {.frames = 32, .rate = 25}).format,
              {.generator = GeneratorKind::rnn});
  texts.save(texts_file);
  for (auto& clip : clips) clip.captions = {clip.id.substr(0, clip.id.find('_'))};
  ActionGan actions(
      context,
      motion::ActionDataset::from_motions(clips, {.frames = frames, .rate = 30, .train_share = 1}).format,
      {});
  actions.save(classes_file);
  const motion::Motion prior = motion::read_motion(prior_file).motion;
  {
    Cpp cpp(texts, nullptr);
    C c(texts_file, "", texts.format().skeleton().size());
    compare("texts", cpp, c, rounds, json);
  }
  {
    Cpp cpp(actions, &prior);
    C c(classes_file, prior_file, actions.format().skeleton().size());
    compare("classes", cpp, c, rounds, json);
  }
  std::filesystem::remove_all(folder);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    std::size_t rounds = 15;
    bool json = false;
    for (int i = 1; i < argc; ++i) {
      const std::string name = argv[i];
      if (name == "--json")
        json = true;
      else if (name == "--rounds" && i + 1 < argc && std::atoi(argv[i + 1]) > 0)
        rounds = static_cast<std::size_t>(std::atoi(argv[++i]));
      else
        throw Error("unknown argument ", name, "; usage: bench_c [--json] [--rounds 15]");
    }
    return run(rounds, json);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_c: %s\n", error.what());
    return 1;
  }
}
