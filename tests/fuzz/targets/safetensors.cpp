// safetensors files: what is read is written as the same, and its numbers convert or are refused.
#include "../mutate_safetensors.hpp"

#include <motiongan/io/safetensors.hpp>

#include "../memory_folder.hpp"

namespace motiongan::fuzz {
namespace {

template <class T>
void convert(const io::SafeTensor& tensor) {
  try {
    demand(tensor.as<T>().size() == tensor.count(), "all elements are converted");
  } catch (const Error&) {  // another type, or out of range
  }
}

}  // namespace

const Target safetensors_target{
    "safetensors",
    [](std::string_view bytes) {
      const auto file = io::SafeTensors::read(memory_folder().write("input.safetensors", bytes));
      for (const auto& [name, tensor] : file.tensors) {
        convert<double>(tensor);
        convert<float>(tensor);
        convert<int>(tensor);
        convert<std::size_t>(tensor);
      }
      const std::filesystem::path again = memory_folder().path() / "again.safetensors";
      must("a file can be written", [&] { file.write(again); });
      const auto same = must("a written file can be read", [&] { return io::SafeTensors::read(again); });
      demand(same.tensors == file.tensors && same.metadata == file.metadata,
             "a written file reads back as the same");
    },
    mutate_safetensors};

}  // namespace motiongan::fuzz
