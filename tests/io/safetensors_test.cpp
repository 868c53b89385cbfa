#include <doctest/doctest.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <motiongan/io/safetensors.hpp>
#include <string>
#include <vector>

#include "../support/folders.hpp"

namespace safetensors_test {

using motiongan::Error;
using motiongan::io::float_to_half;
using motiongan::io::half_to_float;
using motiongan::io::SafeTensor;
using motiongan::io::SafeTensors;
namespace fs = std::filesystem;

namespace {

/// A folder that goes away with the test.
struct Folder {
  fs::path path = fs::temp_directory_path() / ("motiongan-safetensors-" + std::to_string(::getpid()));
  Folder() { fs::create_directories(path); }
  ~Folder() { fs::remove_all(path); }
};

void put(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

std::string get(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string length_of(std::uint64_t n) {
  std::string bytes(sizeof(n), '\0');
  std::memcpy(bytes.data(), &n, sizeof(n));
  return bytes;
}

/// A file with this header and `data` bytes after it, all of them 'd'.
std::string file_of(const std::string& header, std::size_t data) {
  return length_of(header.size()) + header + std::string(data, 'd');
}

std::string error_of(const fs::path& path) {
  try {
    SafeTensors::read(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

}  // namespace

TEST_CASE("safetensors: what was written is read again, number for number") {
  Folder folder;
  SafeTensors out;
  out.tensors["text.embedding"] = SafeTensor::of<float>({2, 3}, {1, -2, 3.5F, 0, 1e-30F, 1e30F});
  out.tensors["b"] = SafeTensor::of<double>({}, {0.1});
  out.tensors["words"] = SafeTensor::of<std::int64_t>({3}, {-1, 0, std::numeric_limits<std::int64_t>::max()});
  out.tensors["mask"] = SafeTensor::of<std::uint8_t>({1, 3}, {0, 1, 255});
  out.tensors["nothing"] = SafeTensor::of<float>({0, 4}, {});
  out.tensors["\"quoted\" ü"] = SafeTensor::of<std::int32_t>({1}, {-7});
  out.metadata = {{"format", "motiongan"}, {"skeleton", "{\"joints\": [\"Hüfte\"]}\n"}};
  out.write(folder.path / "a");

  const SafeTensors in = SafeTensors::read(folder.path / "a");
  CHECK(in.tensors == out.tensors);
  CHECK(in.metadata == out.metadata);
  CHECK(in.at("text.embedding").as<double>()[2] == 3.5);
  CHECK(in.at("b").as<double>() == std::vector<double>{0.1});
  CHECK(in.at("words").as<std::int64_t>() ==
        std::vector<std::int64_t>{-1, 0, std::numeric_limits<std::int64_t>::max()});
  CHECK(in.at("nothing").as<float>().empty());

  in.write(folder.path / "b");
  const std::string bytes = get(folder.path / "b");
  CHECK(bytes == get(folder.path / "a"));
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), sizeof(length));
  CHECK(length % 8 == 0);
  CHECK_FALSE(motiongan::testing::has_unfinished(folder.path));

  SafeTensors().write(folder.path / "empty");
  CHECK(SafeTensors::read(folder.path / "empty").tensors.empty());
}

TEST_CASE("safetensors: halves round to the nearest, of two to the even one") {
  for (std::uint32_t bits = 0; bits < 0x10000; ++bits) {  // every half is its own nearest
    const auto half = static_cast<std::uint16_t>(bits);
    const float value = half_to_float(half);
    if (std::isnan(value)) continue;
    CHECK(float_to_half(value) == half);
    if (std::isinf(value) || (bits & 0x7FFF) == 0x7BFF) continue;
    // Between it and the next one: half a step goes to the even one, a little more or less to the nearest.
    const float next = half_to_float(static_cast<std::uint16_t>(bits + 1)),
                middle = value + (next - value) / 2;
    CHECK(float_to_half(middle) == bits + (bits & 1));
    CHECK(float_to_half(std::nextafter(middle, value)) == half);
    CHECK(float_to_half(std::nextafter(middle, next)) == bits + 1);
  }
  const float infinity = std::numeric_limits<float>::infinity();
  CHECK(float_to_half(65519.99f) == 0x7BFF);
  CHECK(float_to_half(65520) == 0x7C00);
  CHECK(float_to_half(-infinity) == 0xFC00);
  CHECK(std::isnan(half_to_float(float_to_half(std::numeric_limits<float>::quiet_NaN()))));
}

TEST_CASE("safetensors: a file as others write it: any order of fields, spaces, half precision") {
  Folder folder;
  const std::string header =
      R"( {"h" : {"shape":[4],"dtype":"F16","data_offsets":[4,12]}, "bf":{"dtype":"BF16","shape":[2,1],"data_offsets":[0,4]}}   )";
  const std::uint16_t data[] = {0x3fc0, 0xff80, 0x3c00, 0x0001, 0xfbff, 0x7e00};
  std::string bytes = file_of(header.substr(1), 0);
  bytes.append(reinterpret_cast<const char*>(data), sizeof(data));
  put(folder.path / "x", bytes);
  const SafeTensors in = SafeTensors::read(folder.path / "x");
  CHECK(in.at("bf").shape == std::vector<std::size_t>{2, 1});
  CHECK(in.at("bf").as<float>() == std::vector<float>{1.5F, -std::numeric_limits<float>::infinity()});
  const auto half = in.at("h").as<double>();
  CHECK(half[0] == 1.0);
  CHECK(half[1] == std::ldexp(1.0, -24));
  CHECK(half[2] == -65504.0);
  CHECK(std::isnan(half[3]));
}

TEST_CASE("safetensors: numbers that have no place in what was asked for are refused") {
  CHECK_THROWS_AS(SafeTensor::of<double>({1}, {1e300}).as<float>(), Error);
  CHECK(std::isinf(SafeTensor::of<double>({1}, {std::numeric_limits<double>::infinity()}).as<float>()[0]));
  CHECK_THROWS_AS(SafeTensor::of<std::int64_t>({1}, {1LL << 40}).as<std::int32_t>(), Error);
  CHECK_THROWS_AS(SafeTensor::of<std::int64_t>({1}, {-1}).as<std::size_t>(), Error);
  CHECK_THROWS_AS(SafeTensor::of<std::int64_t>({1}, {1}).as<float>(), Error);
  CHECK_THROWS_AS(SafeTensor::of<float>({1}, {1}).as<std::int64_t>(), Error);
  CHECK_THROWS_AS(SafeTensor::of<float>({2, 2}, {1, 2, 3}), Error);
}

TEST_CASE("safetensors: malformed files are refused, and the message says why") {
  const std::string good = R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})";
  const auto entry = [](const std::string& shape, const std::string& offsets,
                        const std::string& dtype = "\"F32\"") {
    return R"({"a":{"dtype":)" + dtype + R"(,"shape":)" + shape + R"(,"data_offsets":)" + offsets + "}}";
  };
  const auto two = [](const std::string& first, const std::string& second) {
    return R"({"a":{"dtype":"U8","shape":[4],"data_offsets":)" + first +
           R"(},"b":{"dtype":"U8","shape":[4],"data_offsets":)" + second + "}}";
  };
  struct Case {
    std::string bytes, message;
  };
  const Case cases[] = {
      // lengths that lie
      {"", "0 bytes are too few"},
      {"1234567", "7 bytes are too few"},
      {length_of(0), "length 0"},
      {length_of(0) + good, "length 0"},
      {length_of(2), "claims 2 bytes, but only 0 follow"},
      {length_of(good.size() + 1) + good, "cut short"},
      {length_of(99'999'999) + good, "cut short"},
      {length_of(1'000'000'000) + good, "more than the 100000000"},
      {length_of(~0ULL) + good, "more than the 100000000"},
      {file_of(good, 7), "only 7 bytes follow the header"},
      {file_of(good, 0), "only 0 bytes follow the header"},
      {file_of(good, 9), "last 1 bytes of the file belong to no tensor"},
      {file_of("{}", 3), "last 3 bytes of the file belong to no tensor"},
      // headers that are not JSON, not UTF-8, or something else
      {file_of("not json", 0), "does not begin with {"},
      {file_of("[1, 2]", 0), "does not begin with {"},
      {file_of("\xef\xbb\xbf" + good, 8), "does not begin with {"},
      {file_of(" " + good, 8), "does not begin with {"},
      {file_of(good.substr(0, 20), 0), "not JSON"},
      {file_of(good + "x", 8), "not JSON"},
      {file_of(good + std::string(1, '\0') + "x", 8), "zero byte"},
      {file_of("{\"a\xff\":{\"dtype\":\"F32\",\"shape\":[2],\"data_offsets\":[0,8]}}", 8),
       "not JSON in UTF-8"},
      {file_of("{" + std::string(100'000, '['), 0), "not JSON"},
      {file_of(R"({"a":)" + std::string(100'000, '['), 0), "\"a\" is a list, expected an object"},
      // entries that are not what they should be
      {file_of(R"({"a":null})", 0), "is null, expected an object"},
      {file_of(R"({"a":3})", 0), "is the number 3, expected an object"},
      {file_of(R"({"a":"F32"})", 0), "is the string \"F32\", expected an object"},
      {file_of(R"({"a":{}})", 0), "has 0 of them"},
      {file_of(R"({"a":{"dtype":"F32","shape":[2]}})", 8), "has 2 of them"},
      {file_of(R"({"a":{"dtype":"F32","shape":[2],"data_offsets":[0,8],"x":1}})", 8), "unknown field \"x\""},
      {file_of(R"({"a":{"dtype":{"x":1},"shape":[2],"data_offsets":[0,8]}})", 8),
       "\"dtype\" holds an object"},
      {file_of(entry("[2]", "[0,8]", "\"F31\""), 8), "unknown type \"F31\""},
      {file_of(entry("[2]", "[0,8]", "\"\""), 8), "unknown type \"\""},
      {file_of(entry("[2]", "[0,8]", "7"), 8), "\"dtype\" holds the number 7, expected a string"},
      {file_of(entry("2", "[0,8]"), 8), "\"shape\" holds the number 2"},
      {file_of(entry("\"2\"", "[0,8]"), 8), "\"shape\" holds the string"},
      {file_of(entry("[[2]]", "[0,8]"), 8), "\"shape\" holds a list"},
      {file_of(entry("[true]", "[0,8]"), 8), "holds a boolean"},
      {file_of(entry("[null]", "[0,8]"), 8), "holds null"},
      // numbers that are no lengths
      {file_of(entry("[NaN]", "[0,8]"), 8), "not JSON"},
      {file_of(entry("[-2]", "[0,8]"), 8), "the number -2, expected a list of whole numbers"},
      {file_of(entry("[2.5]", "[0,8]"), 8), "the number 2.5"},
      {file_of(entry("[2.0]", "[0,8]"), 8), "the number 2.0"},
      {file_of(entry("[1e400]", "[0,8]"), 8), "not JSON"},
      {file_of(entry("[99999999999999999999]", "[0,8]"), 8), "the number 99999999999999999999"},
      {file_of(entry("[4294967296,4294967296]", "[0,8]"), 8), "more bytes than 64 bits can count"},
      {file_of(entry("[4611686018427387905]", "[0,4]"), 4), "more bytes than 64 bits can count"},
      {file_of(entry("[1000000000000]", "[0,8]"), 8), "takes 4000000000000 bytes"},
      {file_of(entry("[3]", "[0,8]"), 8), "takes 12 bytes"},
      {file_of(entry("[0]", "[0,8]"), 8), "takes 0 bytes"},
      // offsets
      {file_of(entry("[2]", "[8]"), 8), "data_offsets has 1 numbers"},
      {file_of(entry("[2]", "[0,4,8]"), 8), "data_offsets has 3 numbers"},
      {file_of(entry("[2]", "[8,0]"), 8), "end before they begin"},
      {file_of(entry("[2]", "[-8,0]"), 8), "the number -8"},
      {file_of(entry("[2]", "[0,8.0]"), 8), "the number 8.0"},
      {file_of(entry("[2]", "[8,16]"), 8), "ends at byte 16, but only 8"},
      {file_of(entry("[2]", "[18446744073709551608,18446744073709551615]"), 8), "only 8 bytes follow"},
      {file_of(entry("[2]", "[4,12]"), 12), "4 bytes before tensor \"a\" belong to no tensor"},
      {file_of(two("[0,4]", "[2,6]"), 6), "inside the previous tensor"},
      {file_of(two("[0,4]", "[0,4]"), 4), "inside the previous tensor"},
      {file_of(two("[0,4]", "[5,9]"), 9), "1 bytes before tensor \"b\""},
      // names that stand twice
      {file_of(
           R"({"a":{"dtype":"U8","shape":[1],"data_offsets":[0,1]},"a":{"dtype":"U8","shape":[1],"data_offsets":[1,2]}})",
           2),
       "the name \"a\" appears twice"},
      {file_of(R"({"a":{"dtype":"U8","dtype":"I8","shape":[1],"data_offsets":[0,1]}})", 1),
       "\"dtype\" appears twice"},
      {file_of(R"({"__metadata__":{"x":"1","x":"2"}})", 0), "__metadata__: \"x\" appears twice"},
      // metadata
      {file_of(R"({"__metadata__":{"x":1}})", 0), "\"x\" holds the number 1, expected a string"},
      {file_of(R"({"__metadata__":{"x":["1"]}})", 0), "\"x\" holds a list, expected a string"},
      {file_of(R"({"__metadata__":{"x":{"y":"z"}}})", 0), "\"x\" holds an object, expected a string"},
      {file_of(R"({"__metadata__":"x"})", 0), "__metadata__ is the string \"x\", expected an object"},
  };
  Folder folder;
  const fs::path path = folder.path / "bad.safetensors";
  for (const Case& c : cases) {
    put(path, c.bytes);
    const std::string message = error_of(path);
    CAPTURE(message);
    CHECK(message.find(c.message) != std::string::npos);
    CHECK(message.find("bad.safetensors") != std::string::npos);
  }
  put(path, file_of(good, 8));
  CHECK(error_of(path) == "no error");
  CHECK(error_of(folder.path / "absent").find("no such file") != std::string::npos);
  CHECK(error_of(folder.path).find("it is not a regular file") != std::string::npos);
}

namespace {

/// Seconds that reading `header` takes, and what it says.
std::pair<double, std::string> read_in_time(const std::string& header, std::size_t data) {
  const Folder folder;
  put(folder.path / "costly.safetensors", file_of(header, data));
  const auto start = std::chrono::steady_clock::now();
  std::string message = error_of(folder.path / "costly.safetensors");
  return {std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
          std::move(message)};
}

std::string repeated(const std::string& text, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) out += text;
  return out;
}

}  // namespace

TEST_CASE("safetensors: a header cannot cost more than its bytes") {
  const auto tensor = [](const std::string& shape) {
    return R"({"a":{"dtype":"U8","shape":[)" + shape + R"(],"data_offsets":[0,1]}})";
  };
  CHECK(read_in_time(tensor(repeated("1,", 15) + "1"), 1).second == "no error");
  // Time went with the square of the dimensions: 9 MB of them took many minutes.
  const auto [seconds, message] = read_in_time(tensor(repeated("1,", 4'500'000) + "1"), 1);
  CHECK(message.find("tensor \"a\": \"shape\" has more than 16 numbers, the most that are read") !=
        std::string::npos);
  CHECK(seconds < 5);

  std::string many = "{", notes = R"({"__metadata__":{)";
  for (std::size_t i = 0; i <= 100'000; ++i) {
    const std::string name = (i > 0 ? ",\"t" : "\"t") + std::to_string(i) + "\":";
    many += name + R"({"dtype":"U8","shape":[0],"data_offsets":[0,0]})";
    notes += name + "\"\"";
  }
  CHECK(read_in_time(many + "}", 0).second.find("more than 100000 tensors") != std::string::npos);
  CHECK(read_in_time(notes + "}}", 0).second.find("__metadata__ has more than 100000 members") !=
        std::string::npos);
}

TEST_CASE("safetensors: every truncation of a file is refused") {
  Folder folder;
  SafeTensors out;
  out.tensors["a"] = SafeTensor::of<float>({3}, {1, 2, 3});
  out.metadata["k"] = "v";
  out.write(folder.path / "whole");
  const std::string whole = get(folder.path / "whole");
  for (std::size_t n = 0; n < whole.size(); ++n) {
    put(folder.path / "cut", whole.substr(0, n));
    CAPTURE(n);
    CHECK_THROWS_AS(SafeTensors::read(folder.path / "cut"), Error);
  }
}

TEST_CASE("safetensors: a write that fails leaves the old file as it was") {
  Folder folder;
  SafeTensors good;
  good.tensors["a"] = SafeTensor::of<float>({1}, {1});
  good.write(folder.path / "model");
  const std::string before = get(folder.path / "model");

  SafeTensors bad = good;
  bad.tensors["b"] = {"F32", {2}, std::vector<std::byte>(3)};
  CHECK_THROWS_AS(bad.write(folder.path / "model"), Error);
  bad.tensors["b"] = {"F31", {0}, {}};
  CHECK_THROWS_AS(bad.write(folder.path / "model"), Error);
  bad = good;
  bad.tensors["\xff"] = good.tensors["a"];
  CHECK_THROWS_AS(bad.write(folder.path / "model"), Error);
  bad = good;
  bad.tensors["__metadata__"] = good.tensors["a"];
  CHECK_THROWS_AS(bad.write(folder.path / "model"), Error);
  CHECK(get(folder.path / "model") == before);
  CHECK_FALSE(motiongan::testing::has_unfinished(folder.path));

  CHECK_THROWS_AS(good.write(folder.path / "no such folder" / "model"), Error);
  fs::create_directory(folder.path / "taken");
  put(folder.path / "taken" / "x", "x");
  CHECK_THROWS_AS(good.write(folder.path / "taken"), Error);
  CHECK_FALSE(motiongan::testing::has_unfinished(folder.path));
}

TEST_CASE("safetensors: every whole type is read with its sign") {
  const auto tensor = [](const char* dtype, std::vector<unsigned char> bytes) {
    SafeTensor t{dtype, {1}, {}};
    for (const unsigned char b : bytes) t.data.push_back(std::byte{b});
    return t;
  };
  CHECK(tensor("I8", {0x80}).as<std::int64_t>()[0] == -128);
  CHECK(tensor("U8", {0x80}).as<std::int64_t>()[0] == 128);
  CHECK(tensor("BOOL", {1}).as<int>()[0] == 1);
  CHECK(tensor("I16", {0xfe, 0xff}).as<int>()[0] == -2);
  CHECK(tensor("U16", {0xfe, 0xff}).as<int>()[0] == 65534);
  CHECK(tensor("I32", {0xfd, 0xff, 0xff, 0xff}).as<int>()[0] == -3);
  CHECK(tensor("U32", {0xfd, 0xff, 0xff, 0xff}).as<std::int64_t>()[0] == 4294967293);
  CHECK_THROWS_AS(tensor("U32", {0xfd, 0xff, 0xff, 0xff}).as<int>(), Error);
  CHECK_THROWS_AS(tensor("U64", std::vector<unsigned char>(8, 0xff)).as<std::int64_t>(), Error);
  CHECK_THROWS_AS(tensor("I32", {1, 2}).as<int>(), Error);
}

}  // namespace safetensors_test
