// motiongan ablate dvgan: measures the trained variants and writes the tables.
#include "ablate/ablate_dvgan.hpp"
#include "motiongan/formats/text_file.hpp"
#include "motiongan/train/run.hpp"

namespace motiongan::command {
namespace {

using Row = std::vector<std::string>;

/// The paper's columns; "-" if it has no such row.
Row paper_cells(const paper::GeneratorRow* row) {
  if (row == nullptr) return Row(5, "-");
  Row out{fmt::format("{:.2f}", row->inception_score)};
  for (const double r : row->recall) out.push_back(fmt::format("{:.1f}", r));
  return out;
}

/// "-" if it is not finite.
std::string number(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

/// A column's value of one model.
double value_of(const AblationColumn& column, const ModelEvaluation& model) {
  return column.measure(model.measures, model.distance.distance);
}

Row cells(const DvganAblationRow& row) {
  Row out{row.variant.name(), std::to_string(row.runs.size())};
  for (const AblationColumn& column : ablation_columns())
    out.push_back(cell(row.over_seeds([&](const ModelEvaluation& e) { return value_of(column, e); }),
                       [&](double value) { return number(value, column.decimals); }));
  return out;
}

Row head() {
  Row out{"variant", "seeds"};
  for (const AblationColumn& column : ablation_columns()) out.emplace_back(column.name);
  return out;
}

/// Real windows of the test clips, measured like generated motion; their FID is that of windows of training
/// clips.
Row real_cells(const RealEvaluation& real) {
  Row out{"real", "-"};
  for (const AblationColumn& column : ablation_columns())
    out.push_back(number(column.measure(real.measures, real.training ? real.training->distance : NAN),
                         column.decimals));
  return out;
}

std::string markdown_line(const Row& row) {
  std::string out = "|";
  for (const std::string& text : row) out += " " + text + " |";
  return out + "\n";
}

/// Prints the differences of R@1 and IS between two rows, paired by seed.
void print_difference(const std::vector<DvganAblationRow>& rows, std::string_view a, std::string_view b) {
  const DvganAblationRow *from = nullptr, *to = nullptr;
  for (const DvganAblationRow& row : rows) {
    if (row.variant.name() == a) from = &row;
    if (row.variant.name() == b) to = &row;
  }
  if (from == nullptr || to == nullptr) return;
  const auto difference = [&](std::size_t column) {
    const AblationColumn& c = ablation_columns()[column];
    return paired_difference(*from, *to, [&](const ModelEvaluation& e) { return value_of(c, e); });
  };
  const MeanStd recall = difference(1), score = difference(0);
  if (recall.count == 0) return;
  const auto text = [](const MeanStd& m, int decimals) {
    return cell(m, [&](double value) { return fmt::format("{:.{}f}", value, decimals); });
  };
  fmt::print("{} over {}, paired by seed ({}): R@1 {}{}, IS {}{}\n", b, a, counted(recall.count, "pair"),
             recall.mean > 0 ? "+" : "", text(recall, 1), score.mean > 0 ? "+" : "", text(score, 2));
}

void write_files(const fs::path& save, const std::vector<DvganAblationRow>& rows,
                 const RealEvaluation& real) {
  const std::size_t k = real.measures.retrieval.descriptions;
  std::string runs = "variant,generator,critic,validation,shift,cut,seed,iterations";
  std::string table = "variant,generator,critic,validation,shift,cut,seeds";
  for (const AblationColumn& column : ablation_columns()) {
    runs += "," + std::string(column.name);
    table += fmt::format(",{0},{0} spread", column.name);
  }
  runs += "\n", table += ",paper CMU IS,paper CMU R@1,paper CMU R@3,paper CMU R@5,paper CMU R@10\n";
  const auto fields = [](const DvganVariant& v) {
    return fmt::format("{},{},{},{},{:d},{:d}", v.name(), v.generator == GeneratorKind::cnn ? "cnn" : "rnn",
                       v.critic == CriticKind::cnn ? "cnn" : "rnn", v.validation_name(), v.shift, v.cut);
  };
  const auto paper_fields = [](const paper::GeneratorRow* row) {
    std::string out;
    for (const std::string& text : paper_cells(row)) out += "," + (text == "-" ? std::string() : text);
    return out + "\n";
  };
  for (const DvganAblationRow& row : rows) {
    for (const DvganRun& run : row.runs) {
      runs += fmt::format("{},{},{}", fields(row.variant), run.seed, run.iterations);
      for (const AblationColumn& column : ablation_columns())
        runs += fmt::format(",{:.6g}", value_of(column, run.evaluation));
      runs += "\n";
    }
    table += fmt::format("{},{}", fields(row.variant), row.runs.size());
    for (const AblationColumn& column : ablation_columns()) {
      const MeanStd m = row.over_seeds([&](const ModelEvaluation& e) { return value_of(column, e); });
      table += fmt::format(",{:.6g},{:.6g}", m.mean, m.spread);
    }
    table += paper_fields(row.variant.find(paper::table2_cmu));
  }
  table += "real,,,,,,";
  for (const AblationColumn& column : ablation_columns())
    table +=
        fmt::format(",{:.6g},", column.measure(real.measures, real.training ? real.training->distance : NAN));
  table += paper_fields(&paper::real_cmu);

  std::string text = fmt::format(
      "# Tables 2 and S1 on these clips\n\nMean ± standard deviation over seeds. K = {} descriptions of {} "
      "test "
      "clips, {} motions of each variant. IS in nats (its exponential is what most papers print), R@k in "
      "percent, FID, diversity and multimodality in the ranker's embedding of unit length, jerk in {}/s^3, "
      "feet as in `motiongan evaluate motion`. The real row's FID is that of windows of training clips. The "
      "paper's columns, on the right, are for other clips, "
      "another K and another ranker: only the order of the rows can be compared.\n\n",
      k, real.clips, real.measures.motions, real.measures.quality.length_unit);
  Row titles = head();
  for (const char* corpus : {"CMU", "H3.6M"})
    for (const char* column : {"IS", "R@1", "R@3", "R@5", "R@10"})
      titles.push_back(fmt::format("paper {} {}", corpus, column));
  text += markdown_line(titles) + markdown_line(Row(titles.size(), "---"));
  const auto line = [&](Row row, const paper::GeneratorRow* cmu, const paper::GeneratorRow* h36m) {
    for (const paper::GeneratorRow* p : {cmu, h36m})
      for (std::string& c : paper_cells(p)) row.push_back(std::move(c));
    text += markdown_line(row);
  };
  for (const DvganAblationRow& row : rows) {
    const paper::GeneratorRow* h36m = row.variant.find(paper::table2_h36m);
    line(cells(row), row.variant.find(paper::table2_cmu),
         h36m != nullptr ? h36m : row.variant.find(paper::table_s1_h36m));
  }
  line(real_cells(real), &paper::real_cmu, &paper::real_h36m);
  Row chance{"random", "-", "-"};
  for (const double r : random_recall(k)) chance.push_back(fmt::format("{:.1f}", r));
  for (std::size_t i = chance.size(); i < titles.size(); ++i) chance.emplace_back("-");
  text += markdown_line(chance);

  for (const auto& [name, content] :
       {std::pair{"runs.csv", &runs}, std::pair{"table.csv", &table}, std::pair{"table.md", &text}}) {
    motion::write_text_atomically(save / name, *content);
    fmt::print("wrote {}\n", shown(save / name));
  }
}

}  // namespace

void report_dvgan_variants(const Context& context, const motion::Dataset& data, const Ranker& ranker,
                           const fs::path& save, const std::vector<DvganVariant>& variants,
                           const std::vector<std::uint64_t>& seeds, const ModelEvaluationOptions& options) {
  const RealEvaluation real = evaluate_real(ranker, data, options);
  std::vector<DvganAblationRow> rows;
  std::vector<std::size_t> budgets;
  for (const DvganVariant& variant : variants) {
    DvganAblationRow& row = rows.emplace_back(DvganAblationRow{variant, {}});
    for (const std::uint64_t seed : seeds) {
      const RunFiles files{folder_of(save, variant.name(), seed)};
      if (!fs::exists(files.generator())) continue;
      const Dvgan model = Dvgan::load(context, files.generator());
      ModelEvaluationOptions asked = options;
      asked.drift_motions = 0;  // only windows are compared here
      row.runs.push_back(
          {seed, read_run_record(files.checkpoint()).iteration, evaluate_model(model, ranker, real, asked)});
      budgets.push_back(row.runs.back().iterations);
      fmt::print(stderr, "measured {} seed {}\n", variant.name(), seed);
    }
  }
  std::erase_if(rows, [](const DvganAblationRow& row) { return row.runs.empty(); });
  require(!rows.empty(), save.string(), " holds none of the requested models; train them first");

  const auto [least, most] = std::minmax_element(budgets.begin(), budgets.end());
  fmt::print(
      "\nK = {} of {}, {} motions each; {}\n\n", counted(real.measures.retrieval.descriptions, "description"),
      counted(real.clips, "test clip"), real.measures.motions,
      *least == *most ? counted(*most, "iteration") : fmt::format("{} to {} iterations", *least, *most));
  std::vector<Row> lines;
  for (const DvganAblationRow& row : rows) {
    lines.push_back(cells(row));
    for (std::string& c : paper_cells(row.variant.find(paper::table2_cmu)))
      lines.back().push_back(std::move(c));
  }
  lines.push_back(real_cells(real));
  for (std::string& c : paper_cells(&paper::real_cmu)) lines.back().push_back(std::move(c));
  Row random{"random", "-", "-"};
  for (const double r : random_recall(real.measures.retrieval.descriptions))
    random.push_back(fmt::format("{:.1f}", r));
  Row titles = head();
  for (const char* column : {"paper: IS", "R@1", "R@3", "R@5", "R@10"}) titles.emplace_back(column);
  random.resize(titles.size(), "-");
  lines.push_back(std::move(random));
  print_table(titles, lines, "l" + std::string(titles.size() - 1, 'r'));
  fmt::print(
      "\nThe paper's columns are for its own CMU clips, K = 250, and its own ranker: not comparable, except "
      "for the order of the rows.\n");
  print_difference(rows, "cnn-cnn-final", "cnn-cnn-mod2");
  print_difference(rows, "cnn-cnn-mod2", "cnn-cnn-dense");
  print_difference(rows, "cnn-cnn-final", "cnn-cnn-dense");
  print_difference(rows, "cnn-cnn-dense", "cnn-cnn-dense-shift");
  print_difference(rows, "cnn-cnn-dense-shift", "cnn-cnn-dense-shift-cut");
  write_files(save, rows, real);
}

}  // namespace motiongan::command
