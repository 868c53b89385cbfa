// Atomic files, checksums and folder locks.
#include "motiongan/io/atomic_file.hpp"

#include <doctest/doctest.h>
#include <signal.h>
#include <sys/wait.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>

#include "../support/folders.hpp"
#include "../support/messages.hpp"
#include "motiongan/io/folder_lock.hpp"
#include "motiongan/io/safetensors.hpp"

namespace atomic_file_test {

using namespace motiongan;
using namespace motiongan::io;
using namespace motiongan::testing;
namespace fs = std::filesystem;

namespace {

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}
void put(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::size_t files_in(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
}

}  // namespace

TEST_CASE("a file appears whole or not at all, and leaves nothing beside it") {
  const Scratch scratch;
  const fs::path path = scratch.path / "a";
  put(path, "before");
  {
    AtomicFile given_up(path);
    given_up.write("half");
    CHECK(files_in(scratch.path) == 2);
  }
  CHECK(bytes_of(path) == "before");
  AtomicFile first(path), second(path);  // each has a name of its own
  first.write("first");
  second.write("second");
  first.commit();
  CHECK(bytes_of(path) == "first");
  second.commit();
  CHECK(bytes_of(path) == "second");
  CHECK(files_in(scratch.path) == 1);
}

TEST_CASE("a link that somebody planted is not written through") {
  const Scratch scratch;
  const fs::path path = scratch.path / "a", other = scratch.path / "other";
  put(other, "kept");
  for (int n = 0; n < 3; ++n)
    fs::create_symlink(other, scratch.path / concat("a.", ::getpid(), "-", n, ".tmp"));
  fs::create_symlink(other, scratch.path / "a.tmp");
  AtomicFile file(path);
  file.write("new");
  file.commit();
  CHECK(bytes_of(path) == "new");
  CHECK(bytes_of(other) == "kept");
}

TEST_CASE("a device is written directly and stays") {
  CHECK(says(message_of([] { AtomicFile("/dev/full").write("x"); }), "No space left"));
  AtomicFile null("/dev/null");
  null.write("x");
  null.commit();
  CHECK(fs::is_character_file("/dev/null"));
}

TEST_CASE("a file in the memory folder of /dev is a file like any other") {
  const fs::path path = concat("/dev/shm/motiongan_atomic_file_test.", ::getpid());
  if (::access("/dev/shm", W_OK) != 0) {
    MESSAGE("skipped: /dev/shm cannot be written");
    return;
  }
  for (const char* const text : {"a longer text", "new"}) {
    AtomicFile file(path);
    file.write(text);
    file.commit();
    CHECK(bytes_of(path) == text);
  }
  fs::remove(path);
}

TEST_CASE("left-over files are told by their names") {
  CHECK(is_left_over("log.csv.12-0.tmp", "log.csv"));
  CHECK(is_left_over("log.csv.x.tmp", "log.csv"));
  CHECK_FALSE(is_left_over("log.csv", "log.csv"));
  CHECK_FALSE(is_left_over("log.csv.tmp", "log.csv"));
  CHECK_FALSE(is_left_over("other.csv.12-0.tmp", "log.csv"));
  CHECK_FALSE(is_left_over("log.csv.12-0.tmp2", "log.csv"));
}

TEST_CASE("every flipped bit of a file is found") {
  const Scratch scratch;
  const fs::path path = scratch.path / "a", bad = scratch.path / "b";
  SafeTensors file;
  file.metadata["iteration"] = "12";
  file.tensors["weight"] = SafeTensor::of<float>({2, 3}, {1, 2, 3, 4, 5, 6});
  file.tensors["empty"] = SafeTensor::of<float>({0}, {});
  file.write(path);
  CHECK(SafeTensors::read(path).metadata == file.metadata);
  const std::string bytes = bytes_of(path);
  for (std::size_t i = 0; i < 8 * bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i / 8] = static_cast<char>(changed[i / 8] ^ (1 << i % 8));
    put(bad, changed);
    CAPTURE(i);
    const std::string message = message_of([&] { SafeTensors::read(bad); });
    const bool in_padding = i / 8 < bytes.size() - 24 && bytes[i / 8] == ' ';
    // A key that is no longer "crc32" is a file without a checksum, as earlier versions wrote it.
    const std::size_t key = bytes.find("crc32");
    if (in_padding || (i / 8 >= key && i / 8 < key + 5)) continue;
    CHECK(says(message, bad.string()));
    if (i / 8 >= bytes.size() - 24) CHECK(says(message, "the file is damaged: its checksum is "));
  }
}

TEST_CASE("a folder has one lock, which names its holder and ends with the process") {
  const Scratch scratch;
  auto lock = std::make_unique<FolderLock>(scratch.path);
  CHECK(says(message_of([&] { FolderLock second(scratch.path); }), concat("process ", ::getpid(), " on ")));
  lock.reset();
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const FolderLock held(scratch.path);
    static_cast<void>(!::write(ready[1], "x", 1));
    for (;;) ::pause();
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  CHECK(says(message_of([&] { FolderLock second(scratch.path); }), concat("process ", child, " on ")));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(message_of([&] { FolderLock second(scratch.path); }) == "no error");
  CHECK(says(message_of([&] { FolderLock none(scratch.path / "none"); }), "does the folder exist"));
}

}  // namespace atomic_file_test
