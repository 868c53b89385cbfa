// Logs of training runs: read as a table, and continued after iteration 20.
#include <motiongan/train/csv_log.hpp>

#include "../memory_folder.hpp"
#include "../target.hpp"

namespace motiongan::fuzz {

const Target training_log_target{
    "training_log", [](std::string_view bytes) {
      const std::filesystem::path file = memory_folder().write("log.csv", bytes);
      const CsvTable log = read_csv_log(file);
      for (const auto& row : log.rows)
        demand(row.size() == log.columns.size(), "a row has a number for every column");
      const std::vector<std::string> columns(log.columns.begin() + 1, log.columns.end());
      CsvLog resumed(file, columns, 20);
      const std::vector<double> values(columns.size(), 0.5);
      resumed.append(21, values);
      must("a continued log can be read", [&] { return read_csv_log(file); });
    }};

}  // namespace motiongan::fuzz
