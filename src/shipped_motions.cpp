// What the shipped models make of some of their descriptions.
#include "shipped_motions.hpp"

#include "motiongan/formats/bvh.hpp"
#include "motiongan/models/dvgan.hpp"
#include "motiongan/models/shipped_models.hpp"
#include "shared/cleaning.hpp"
#include "shared/prompt.hpp"
#include "shared/show.hpp"

namespace motiongan::command {
namespace {

constexpr std::size_t motions_shown = 12;
constexpr double shown_rate = 30;

std::vector<Dvgan> text_models(const Context& context) {
  std::vector<Dvgan> out;
  for (const ShippedModel& model : shipped_models()) {
    check_shipped(model);
    const io::SafeTensors file = io::SafeTensors::read(model.file);
    if (holds_model<Dvgan>(file)) out.push_back(model_from<Dvgan>(context, file, model.file.string()));
  }
  return out;
}

}  // namespace

void show_shipped_motions(const Context& context, const fs::path& out) {
  const std::vector<Dvgan> models = text_models(context);
  if (models.empty()) {
    fmt::print("no shipped model that takes a text is installed\n");
    return;
  }
  make_folder(out / "shipped");
  const Cleaning cleaning{{"feet", "smooth"}, {}};
  std::vector<view::ViewedMotion> page;
  // Each model makes the next of its descriptions in turn.
  for (std::size_t i = 0, skipped = 0; page.size() < motions_shown && skipped < models.size(); ++i) {
    const Dvgan& model = models[i % models.size()];
    const std::vector<std::string>& texts = model.format().descriptions;
    const std::size_t which = i / models.size();
    skipped = which < texts.size() ? 0 : skipped + 1;
    if (which >= texts.size()) continue;
    motion::Motion made =
        model.generate(texts[which], {.count = 1, .seed = 1, .first_sample = static_cast<std::uint32_t>(i)})
            .front();
    made = motion::resample(cleaning.apply(std::move(made)), shown_rate);
    motion::write_bvh(out / "shipped" / (slug(texts[which]) + ".bvh"), made);
    page.push_back({texts[which], std::move(made)});
  }
  fmt::print("wrote {}: {} BVH files\n", (out / "shipped").string(), page.size());
  show_page(out / "shipped.html", page, "motiongan: what the shipped models make of a text", 4);
  show_strip(out / "shipped.png", page);
}

}  // namespace motiongan::command
