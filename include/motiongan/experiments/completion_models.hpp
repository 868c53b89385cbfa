// Models in the completion experiment (Lin & Amer, Table 3): their training data and their errors.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "motiongan/data/dataset.hpp"
#include "motiongan/experiments/completion_protocol.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/prediction_model.hpp"
#include "motiongan/train/prediction_windows.hpp"

namespace motiongan {

/// The training data of the baselines.
inline PredictionData prediction_data(const CompletionData& data) {
  PredictionData out{
      .dof = data.dof(), .sequences = {}, .actions = {}, .action_count = data.classes().size()};
  for (const CompletionClip& clip : data.train()) {
    out.sequences.push_back(clip.poses);
    out.actions.push_back(clip.label);
  }
  return out;
}

/// The errors of a baseline, averaged by action, [actions].
inline std::vector<CompletionErrors> prediction_errors(const PredictionModel& model,
                                                       const CompletionData& data) {
  using P = CompletionProtocol;
  const std::size_t dof = data.dof(), batch = data.tests().size();
  std::vector<float> prefixes(P::prefix * batch * dof);
  std::vector<std::size_t> labels;
  for (std::size_t b = 0; b < batch; ++b) {
    const CompletionTest& test = data.tests()[b];
    labels.push_back(test.label);
    for (std::size_t f = 0; f < P::prefix; ++f)
      std::copy_n(test.prefix.data() + f * dof, dof, prefixes.data() + (f * batch + b) * dof);
  }
  const std::vector<float> made = model.predict(prefixes, batch, labels, P::future);
  std::vector<CompletionErrors> errors;
  std::vector<float> one(P::future * dof);
  for (std::size_t b = 0; b < batch; ++b) {
    for (std::size_t f = 0; f < P::future; ++f)
      std::copy_n(made.data() + (f * batch + b) * dof, dof, one.data() + f * dof);
    errors.push_back(data.errors(data.tests()[b], one));
  }
  return mean_by_action(data, errors);
}

/// The training data of DVGAN: windows of `frames` poses, `stride` of the protocol's frames apart (2: 12.5 Hz
/// for Human3.6M), captioned with the action's name. The columns of the text are used unchanged as the pose
/// vector, with a placeholder flat skeleton. All clips are for training; those that are too short are listed
/// in `skipped`. Throws Error if every clip is.
inline motion::Dataset completion_dataset(const CompletionData& data, std::size_t frames,
                                          std::size_t stride) {
  require(frames > 0 && stride > 0, "frames is ", frames, " and stride is ", stride,
          ", expected at least 1 of each");
  motion::Dataset out;
  motion::Skeleton skeleton;
  const std::vector<motion::Channel> turns{motion::Channel::z_rotation, motion::Channel::y_rotation,
                                           motion::Channel::x_rotation};
  for (std::size_t j = 0; j < data.columns() / 3; ++j)
    skeleton.joints.push_back({concat("joint_", j), j == 0 ? -1 : 0, {}, turns, {}});
  out.format.layout = motion::PoseLayout(std::move(skeleton), false, 0, motion::RootRotation::expmap);
  out.format.normalizer = data.normalizer();
  out.format.rate = data.rate() / static_cast<double>(stride);
  out.format.frames = frames;
  out.stride = stride;
  out.options.frames = frames;
  out.options.rate = out.format.rate;
  out.options.root_position = false;
  out.options.root_rotation = motion::RootRotation::expmap;
  out.options.train_share = 1;
  std::vector<std::string> captions;
  std::size_t longest = 0;
  for (const CompletionClip& clip : data.train()) {
    const std::string& caption = data.classes()[clip.label];
    longest = std::max(longest, clip.frames);
    motion::DatasetClip made{clip.id, {caption}, {}, clip.frames, clip.poses};
    if (out.starts(made) == 0) {
      out.skipped.push_back(
          {clip.id, concat(clip.frames, " frames, a window needs ", (frames - 1) * stride + 1)});
      continue;
    }
    captions.push_back(caption);
    out.train.push_back(std::move(made));
  }
  require(!out.train.empty(), "no training file holds ", frames, " frames with a stride of ", stride,
          "; the longest allows ", longest == 0 ? 0 : (longest - 1) / stride + 1, " frames");
  motion::dataset_detail::fit_range(out);
  out.format.check();
  out.format.vocabulary = motion::Vocabulary::from_captions(captions);
  for (motion::DatasetClip& clip : out.train)
    for (const std::string& caption : clip.captions)
      clip.sentences.push_back(out.format.vocabulary.encode(caption));
  return out;
}

/// Errors by action, [actions], of several sampled completions of each test.
struct SampledErrors {
  std::vector<CompletionErrors> mean;  ///< mean over the samples
  std::vector<CompletionErrors> best;  ///< smallest error among the samples, at each time separately
};

/// The errors of a DVGAN that was trained on completion_dataset() with this stride. The prefix is every
/// stride-th of the 50 frames, including the last; errors at times between the model's frames are NaN. Sample
/// i of test t is the same motion whatever the number of samples. Throws Error if the model has a CNN
/// generator or was trained on other data.
inline SampledErrors dvgan_errors(const Dvgan& model, const CompletionData& data, std::size_t stride,
                                  std::size_t samples, std::uint64_t seed) {
  using P = CompletionProtocol;
  const std::size_t dof = data.dof();
  require(samples > 0 && samples < 65536, "samples is ", samples, ", expected 1 to 65535");
  require(stride > 0 && stride <= P::future, "stride is ", stride, ", expected 1 to ", P::future);
  require(model.format().normalizer.kept() == data.normalizer().kept(),
          "the model was trained on other data: it has ", model.format().dof(), " of ",
          model.format().normalizer.full_dof(), " channels, the data has ", dof, " of ", data.columns());
  const std::size_t first = (P::prefix - 1) % stride, given = (P::prefix - 1 - first) / stride + 1;
  const std::size_t made_frames = P::future / stride;
  std::vector<CompletionErrors> mean, best;
  for (std::size_t t = 0; t < data.tests().size(); ++t) {
    const CompletionTest& test = data.tests()[t];
    std::vector<float> prior;
    for (std::size_t f = first; f < P::prefix; f += stride)
      prior.insert(prior.end(), test.prefix.begin() + static_cast<std::ptrdiff_t>(f * dof),
                   test.prefix.begin() + static_cast<std::ptrdiff_t>((f + 1) * dof));
    std::vector<StreamStart> starts;
    const std::vector<int> sentence = model.format().vocabulary.encode(data.actions()[test.action]);
    for (std::size_t s = 0; s < samples; ++s)
      starts.push_back({sentence, seed, static_cast<std::uint32_t>((t % P::tests) * 65536 + s)});
    RnnStream stream(model.rnn());
    stream.add(starts, prior, given);
    const std::span<const float> made = stream.step(made_frames);  // [made_frames, samples, dof]
    CompletionErrors sum{}, least;
    least.fill(std::numeric_limits<double>::infinity());
    for (std::size_t s = 0; s < samples; ++s) {
      // Frames between the model's repeat the previous one; they are not measured.
      std::vector<float> prediction(P::future * dof);
      for (std::size_t f = 0; f < P::future; ++f) {
        const std::size_t m = std::clamp<std::size_t>((f + 1) / stride, 1, made_frames) - 1;
        std::copy_n(made.data() + (m * samples + s) * dof, dof, prediction.data() + f * dof);
      }
      const CompletionErrors errors = data.errors(test, prediction);
      for (std::size_t m = 0; m < errors.size(); ++m) {
        sum[m] += errors[m] / static_cast<double>(samples);
        least[m] = std::min(least[m], errors[m]);
      }
    }
    for (std::size_t m = 0; m < sum.size(); ++m)
      if ((P::measured[m] + 1) % stride != 0) sum[m] = least[m] = std::numeric_limits<double>::quiet_NaN();
    mean.push_back(sum);
    best.push_back(least);
  }
  return {mean_by_action(data, mean), mean_by_action(data, best)};
}

}  // namespace motiongan
