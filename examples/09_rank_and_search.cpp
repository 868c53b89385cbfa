// Evaluates a generator with a ranker, and finds clips whose motion matches a text. For your own clips:
// motion::Dataset::from_bvh("clips", {.captions = "captions.tsv"}).
#include <cstdio>
#include <motiongan.hpp>
using namespace motiongan;

int main() {
  Context ctx;
  const auto motions = motion::procedural_motions({.clips = 34, .seconds = 5, .rate = 8});
  const auto data = motion::Dataset::from_motions(motions, {.frames = 8, .rate = 4});

  // A ranker scores how well a text fits a motion: R@k on the clips held out for testing.
  Ranker ranker(ctx, data.format, {.kind = RankerKind::rnn, .hidden = 32});
  train(ranker, data, {.iterations = 60, .batch = 16, .adam = {.learning_rate = 3e-3}});
  const RankerEvaluation known = evaluate_ranker(ranker, data);
  std::printf("R@1 %.1f%% of %zu descriptions, chance %.1f%%\n", known.retrieval.recall[0],
              known.retrieval.descriptions, random_recall(known.retrieval.descriptions)[0]);

  // A generator compared with real motion by that ranker.
  Dvgan model(ctx, data.format, {.hidden = 16});
  train(model, data, DvganTrainOptions{.iterations = 20, .critic_steps = 2, .batch = 8});
  const ModelEvaluationOptions options{.samples = 4};
  const RealEvaluation real = evaluate_real(ranker, data, options);
  const ModelEvaluation made = evaluate_model(model, ranker, real, options);
  std::printf("inception score %.2f nats (real %.2f), FID %.3f\n", made.measures.inception_score,
              real.measures.inception_score, made.distance.distance);

  // A collection of BVH files, and the clips nearest to sixteen hypotheses.
  std::filesystem::create_directories("collection");
  for (const auto& m : motions) motion::write_bvh("collection/" + m.id + ".bvh", m.motion);
  const SearchCollection collection = open_search_collection("collection", model.format());
  const auto hypotheses = model.generate_poses("walk", {.count = 16});
  for (const SearchHit& hit : rank_clips(ctx, collection.index, hypotheses, {.top = 3}).hits)
    std::printf("%s at frame %zu, distance %.2f\n", collection.index.clips()[hit.window.clip].path.c_str(),
                hit.window.frame, hit.distance());
}
