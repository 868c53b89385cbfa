// Which files of a folder are clips.
#include "motiongan/formats/clip_files.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <vector>

#include "../support/messages.hpp"
#include "motiongan/formats/read_motion.hpp"

namespace clip_files_test {

using namespace motiongan;
using namespace motiongan::motion;
using motiongan::testing::message_of;
using motiongan::testing::says;
namespace fs = std::filesystem;

namespace {

struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan_clip_files_" + std::to_string(::getpid()));
  Folder() {
    fs::remove_all(path);
    fs::create_directories(path);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() { fs::remove_all(path); }

  void write(const fs::path& name, const std::string& text = "x") const {
    fs::create_directories((path / name).parent_path());
    write_text_atomically(path / name, text);
  }
  std::vector<std::string> found(const std::vector<std::string_view>& extensions = {".bvh"}) const {
    std::vector<std::string> out;
    for (const fs::path& file : find_clip_files(path, extensions))
      out.push_back(file.lexically_relative(path).generic_string());
    return out;
  }
};

}  // namespace

TEST_CASE("hidden files are left out; dead links, empty files and upper-case endings are listed") {
  const Folder folder;
  folder.write("a.bvh");
  folder.write("B.BVH");
  folder.write("c.Csv");
  folder.write("d.NPY");
  folder.write("empty.bvh", "");
  folder.write("sub/e.bvh");
  folder.write("._a.bvh");
  folder.write(".hidden.bvh");
  folder.write("__MACOSX/._a.bvh");
  folder.write(".trash/old.bvh");
  fs::create_symlink("gone.bvh", folder.path / "dead.bvh");
  fs::create_symlink("loop.bvh", folder.path / "loop.bvh");
  fs::create_directories(folder.path / "folder.bvh");
  CHECK(folder.found() ==
        std::vector<std::string>{"B.BVH", "a.bvh", "dead.bvh", "empty.bvh", "loop.bvh", "sub/e.bvh"});
  CHECK(folder.found({".csv", ".npy"}) == std::vector<std::string>{"c.Csv", "d.NPY"});
  // A file that is given by name is not judged by it.
  CHECK(find_clip_files(folder.path / "._a.bvh") == std::vector<fs::path>{folder.path / "._a.bvh"});
}

TEST_CASE("a folder without clips, and paths that lead nowhere") {
  const Folder folder;
  const auto error = [&](const fs::path& path) { return message_of([&] { find_clip_files(path); }); };
  CHECK(error(folder.path) == "folder " + folder.path.string() + " and its subfolders have no .bvh file");
  folder.write("._a.bvh");
  CHECK(says(error(folder.path), "have no .bvh file (hidden files, which start with a dot, are not read)"));
  CHECK(says(error(folder.path / "none"), "none does not exist; give a .bvh file or a folder of them"));
  fs::create_symlink("/nowhere/clips", folder.path / "link");
  CHECK(says(error(folder.path / "link"), "link is a dead link (to /nowhere/clips); give a .bvh file"));
  fs::create_symlink("loop", folder.path / "loop");
  CHECK(says(error(folder.path / "loop"), "loop cannot be reached: "));
}

TEST_CASE("only regular files are read: pipes, devices, folders and loops are told apart") {
  const Folder folder;
  const auto error = [&](const fs::path& path) { return message_of([&] { read_text(path, "BVH file"); }); };
  REQUIRE(mkfifo((folder.path / "pipe.bvh").c_str(), 0600) == 0);
  fs::create_symlink("pipe.bvh", folder.path / "link.bvh");
  fs::create_symlink("loop.bvh", folder.path / "loop.bvh");
  fs::create_symlink("gone.bvh", folder.path / "dead.bvh");
  CHECK(says(error(folder.path / "pipe.bvh"), "pipe.bvh is a named pipe, expected a regular file"));
  CHECK(says(error(folder.path / "link.bvh"), "link.bvh is a named pipe, expected a regular file"));
  CHECK(says(error(folder.path / "loop.bvh"), "BVH file " + folder.path.string() + "/loop.bvh cannot be"));
  CHECK(says(error(folder.path / "dead.bvh"), "dead.bvh is a dead link (to gone.bvh)"));
  CHECK(says(error(folder.path / "none.bvh"), "none.bvh does not exist"));
  CHECK(says(error(folder.path), "is a folder, expected a BVH file"));
  CHECK(says(error("/dev/zero"), "/dev/zero is a device, expected a regular file"));
}

TEST_CASE("a folder with pipes is searched without waiting for them") {
  const Folder folder;
  for (const char* name : {"a.bvh", "b.csv", "c.npz", "d.npy"})
    REQUIRE(mkfifo((folder.path / name).c_str(), 0600) == 0);
  const std::vector<fs::path> found = find_motion_files(folder.path);  // a .csv is opened to tell what it is
  REQUIRE(found.size() == 3);
  for (const fs::path& file : found)
    CHECK(says(message_of([&] { read_motion(file); }), "is a named pipe, expected a regular file"));
}

TEST_CASE("a file too large for its kind is refused before it is read") {
  const Folder folder;
  folder.write("huge.bvh");
  fs::resize_file(folder.path / "huge.bvh", largest_text_file + 1);  // sparse
  CHECK(says(message_of([&] { read_text(folder.path / "huge.bvh", "BVH file"); }),
             "huge.bvh has 4294967297 bytes, expected at most 4294967296"));
  folder.write("small.txt", "12345");
  CHECK(read_text(folder.path / "small.txt", "text file", 5) == "12345");
  CHECK(says(message_of([&] { read_text(folder.path / "small.txt", "text file", 4); }),
             "small.txt has 5 bytes, expected at most 4"));
}

}  // namespace clip_files_test
