// ZIP archives and the arrays in them: stored and deflated entries, and damaged or hostile files.
#include <doctest/doctest.h>

#include <motiongan/formats/npz.hpp>
#include <motiongan/formats/zip_archive.hpp>
#include <string>

#include "../support/messages.hpp"
#include "../support/npz_bytes.hpp"

namespace zip_archive_test {

using namespace motiongan;
using namespace motiongan::motion;
using namespace motiongan::testing;

namespace {

std::string long_text() {
  std::string out;
  for (int i = 0; i < 5000; ++i) out += "line " + std::to_string(i % 7) + "\n";
  return out;
}

/// What reading all entries of these bytes says.
std::string refusal(const std::string& bytes) {
  return message_of([&] {
    const ZipArchive archive(bytes, "a.npz");
    for (const ZipEntry& entry : archive.entries()) archive.read(entry);
  });
}

/// `bytes` with `size` bytes at `at` replaced by a number.
std::string patched(std::string bytes, std::size_t at, std::uint64_t value, std::size_t size) {
  return bytes.replace(at, size, little(value, size));
}

}  // namespace

TEST_CASE("stored and deflated entries") {
  for (const bool compress : {false, true}) {
    const std::string bytes = zip_file({{"a.txt", long_text()}, {"empty", ""}, {"b.txt", "b"}}, compress);
    for (const std::string& comment : {std::string(), std::string("PK\5\6 and a comment")}) {
      std::string file = bytes;
      file.replace(file.size() - 2, 2, little(comment.size(), 2)) += comment;
      const ZipArchive archive(file, "a.zip");
      CHECK(archive.entries().size() == 3);
      REQUIRE(archive.find("a.txt") != nullptr);
      CHECK(archive.read(*archive.find("a.txt")) == long_text());
      CHECK(archive.read(*archive.find("empty")).empty());
      CHECK(archive.read(*archive.find("b.txt")) == "b");
      CHECK(archive.find("c.txt") == nullptr);
    }
    CHECK((bytes.size() < long_text().size()) == compress);
  }
}

TEST_CASE("damaged archives are errors") {
  CHECK(says(refusal(""), "a.npz: not a ZIP archive, or truncated"));
  CHECK(says(refusal(std::string(100, 'x')), "not a ZIP archive"));
  for (const bool compress : {false, true}) {
    const std::string good = zip_file({{"a.txt", long_text()}}, compress);
    CHECK(refusal(good) == "no error");
    const std::size_t end = good.size() - 22, entry = end - 46 - 5;
    for (const std::size_t size : {good.size() - 1, end, entry, std::size_t{40}, std::size_t{4}})
      CHECK(says(refusal(good.substr(0, size)), "not a ZIP archive, or truncated"));
    CHECK(says(refusal(patched(good, end + 4, 1, 2)), "in several parts"));
    CHECK(says(refusal(patched(patched(good, end + 8, 2, 2), end + 10, 2, 2)), "ends after 1 entries"));
    CHECK(says(refusal(patched(good, end + 12, 0xFFFFFFFE, 4)), "the ZIP directory has 4294967294 bytes"));
    CHECK(says(refusal(patched(good, end + 16, 0xFFFFFFFE, 4)), "the ZIP directory has"));
    CHECK(says(refusal(patched(good, end + 16, 0xFFFFFFFF, 4)), "ZIP64"));
    CHECK(says(refusal(patched(good, entry + 28, 0xFFFF, 2)),
               "entry 1 of the ZIP directory runs past its end"));
    CHECK(says(refusal(patched(good, entry + 8, 1, 2)), "'a.txt' is encrypted"));
    CHECK(says(refusal(patched(good, entry + 10, 12, 2)), "'a.txt' is compressed by method 12"));
    CHECK(says(refusal(patched(good, entry + 16, 1, 4)), "'a.txt' does not match its size or checksum"));
    CHECK(says(refusal(patched(good, entry + 20, 0xFFFFFFFE, 4)), "but the file ends before them"));
    CHECK(says(refusal(patched(good, entry + 20, 0xFFFFFFFF, 4)), "'a.txt' is a ZIP64 entry"));
    CHECK(says(refusal(patched(good, entry + 20, 10, 4)), "the file is damaged"));
    CHECK(says(refusal(patched(good, entry + 24, 0xFFFFFFF0, 4)), "the file is damaged"));
    CHECK(says(refusal(patched(good, entry + 24, long_text().size() + 1, 4)), "the file is damaged"));
    CHECK(says(refusal(patched(good, entry + 42, end, 4)), "has no header where the ZIP directory says"));
    CHECK(says(refusal(patched(good, entry + 42, 0xFFFFFFF0, 4)), "has no header"));
    CHECK(says(refusal(patched(good, 28, 0xFFFF, 2)), "the file is truncated"));
    for (const std::size_t at : {std::size_t{60}, std::size_t{90}})
      CHECK(says(refusal(patched(good, at, 0x55AA55AA, 4)), "the file is damaged"));
  }
}

TEST_CASE("any byte may be wrong without harm") {
  for (const bool compress : {false, true}) {
    const std::string good = zip_file({{"a.txt", "some text, some text, some text"}, {"b", "b"}}, compress);
    for (std::size_t at = 0; at < good.size(); ++at)
      for (const std::uint64_t value : {0x00u, 0x01u, 0x7Fu, 0xFFu}) refusal(patched(good, at, value, 1));
  }
}

TEST_CASE("arrays of numbers") {
  const NpyArray a = parse_npy_array(npy_file("<f4", "(2, 3)", floats({1, 2, 3, 4, 5, -6.5})), "a");
  CHECK(a.shape == std::vector<std::size_t>{2, 3});
  CHECK(a.values == std::vector<double>{1, 2, 3, 4, 5, -6.5});
  const NpyArray b = parse_npy_array(npy_file("<f8", "(2, 3)", doubles({1, 4, 2, 5, 3, -6.5}), true), "b");
  CHECK(b.values == a.values);
  const NpyArray c = parse_npy_array(npy_file("<f8", "()", doubles({120})), "c");
  CHECK(c.shape.empty());
  CHECK(c.values == std::vector<double>{120});
  CHECK(parse_npy_array(npy_file("<i8", "(1,)", little(60, 8)), "d").values == std::vector<double>{60});
  CHECK(parse_npy_array(npy_file(">i4", "()", std::string("\0\0\0\x78", 4)), "e").values ==
        std::vector<double>{120});
  CHECK(parse_npy_array(npy_file("<i2", "(1,)", little(0xFFFF, 2)), "f").values == std::vector<double>{-1});
  CHECK(parse_npy_array(npy_file("<f4", "(0, 3)", ""), "g").values.empty());
  CHECK(parse_npy_array(npy_file("<f4", "(3, 0)", "", true), "h").values.empty());
}

TEST_CASE("arrays that are damaged or of other types are errors") {
  const auto told = [](const std::string& bytes) {
    return message_of([&] { parse_npy_array(bytes, "a.npz, array 'poses'"); });
  };
  CHECK(says(told(npy_file("|O", "(1,)", "x")), "a.npz, array 'poses': the array is of type '|O', expected"));
  CHECK(says(told(npy_file("<c8", "(1,)", "12345678")), "the array is of type '<c8'"));
  CHECK(says(told(npy_file("<f4", "(2, 3)", floats({1, 2}))),
             "found 8 bytes of numbers, expected 6 x 4 for the shape [2, 3]"));
  CHECK(says(told(npy_file("<f4", "(2,)", floats({1, 2, 3}))), "found 12 bytes of numbers, expected 2 x 4"));
  CHECK(says(told(npy_file("<f4", "(4294967296, 4294967296)", floats({1}))), "but only 4 bytes"));
  CHECK(says(told(npy_file("<f4", "(0, 4294967296, 4294967296, 4294967296)", floats({1}))), "damaged"));
  CHECK(says(told(npy_file("<f4", "(1, 1, 1)", floats({1}), true)), "is in Fortran order"));

  const std::string bytes =
      zip_file({{"betas.npy", npy_file("<f4", "(1,)", floats({1}))}, {"x.txt", ""}}, true);
  const ZipArchive archive(bytes, "a.npz");
  CHECK(npz_array(archive, "betas", "a.npz").values == std::vector<double>{1});
  CHECK(says(message_of([&] { npz_array(archive, "poses", "a.npz"); }),
             "a.npz: there is no array 'poses'; the file has betas"));
}

}  // namespace zip_archive_test
