// Tensors and index arrays on the device.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "motiongan/core/context.hpp"

namespace motiongan {

/// Sizes of the axes, row-major. Motion is [frames, batch, channels].
using Shape = std::vector<std::size_t>;

/// The product of the sizes. Throws Error if that of any of the axes does not fit 64 bits.
inline std::size_t element_count(const Shape& shape) {
  std::size_t n = 1;
  bool none = false;
  for (std::size_t size : shape) {
    none = none || size == 0;
    require(
        !__builtin_mul_overflow(n, size == 0 ? 1 : size, &n), "a tensor of shape ", shape,
        " has more elements than fit 64 bits; use a smaller batch, fewer frames or a smaller hidden width");
  }
  return none ? 0 : n;
}

/// "[32, 64, 93]"
inline std::string to_string(const Shape& shape) { return concat(shape); }

namespace detail {

/// Memory for `count` elements, as many as `shape` has. Throws Error for more than kernels can count. This is
/// the one place where that is checked: all indices, offsets and strides within a tensor are less than its
/// number of elements.
inline std::shared_ptr<Storage> allocate_elements(const Context& context, const Shape& shape,
                                                  std::size_t count, std::size_t element_size) {
  require(count <= context.element_limit(), "a tensor of shape ", shape, " has ", count,
          " elements, kernels count up to ", context.element_limit(),
          "; use a smaller batch, fewer frames or a smaller hidden width");
  return context.allocate(count * element_size);
}

}  // namespace detail

/// A contiguous array on the device, in its context's precision. Copies and views share the data; a new
/// tensor is not initialised.
class Tensor {
 public:
  Tensor() = default;
  /// Throws Error for more elements than kernels can count, or than there is memory for.
  Tensor(const Context& context, Shape shape)
      : context_(context),
        size_(element_count(shape)),
        storage_(detail::allocate_elements(context, shape, size_, context.real_size())),
        shape_(std::move(shape)) {}

  /// A tensor with the given values, converted to the context's precision. Throws Error if their number does
  /// not match the shape.
  template <class T>
  static Tensor from(const Context& context, Shape shape, std::span<const T> values) {
    Tensor t(context, std::move(shape));
    t.write(values);
    return t;
  }
  template <class T>
  static Tensor from(const Context& context, Shape shape, const std::vector<T>& values) {
    return from(context, std::move(shape), std::span<const T>(values));
  }

  /// Whether it has no memory, as one that was constructed without arguments.
  bool empty() const { return storage_ == nullptr; }
  const Context& context() const { return *context_; }
  const Shape& shape() const { return shape_; }
  std::size_t size() const { return size_; }
  /// The size of the elements; 0 if empty.
  std::size_t bytes() const { return empty() ? 0 : size_ * context_->real_size(); }
  /// The size of axis `i`.
  std::size_t dim(std::size_t i) const { return shape_.at(i); }
  /// The number of axes.
  std::size_t rank() const { return shape_.size(); }
  cl_mem buffer() const { return storage_->buffer(); }
  /// Whether both are parts of one memory; in a context that only counts, buffer() does not tell.
  bool shares_memory(const Tensor& other) const { return storage_ == other.storage_; }
  /// Identifies the memory; null for an empty tensor.
  const void* memory() const { return storage_.get(); }
  /// Index of the first element within the buffer.
  std::size_t offset() const { return offset_; }

  /// The same data with another shape. Throws Error if the sizes differ.
  Tensor reshape(Shape shape) const {
    require(element_count(shape) == size_, "cannot reshape ", shape_, " to ", shape);
    Tensor t = *this;
    t.shape_ = std::move(shape);
    return t;
  }

  /// A contiguous part of the same data, from element `first`. Throws Error if it exceeds the tensor.
  Tensor view(std::size_t first, Shape shape) const {
    const std::size_t n = element_count(shape);
    require(first <= size_ && n <= size_ - first, "view of ", n, " elements from ", first, " does not fit ",
            shape_);
    Tensor t = *this;
    t.offset_ += first;
    t.size_ = n;
    t.shape_ = std::move(shape);
    return t;
  }

  /// Uploads without waiting for the queue. Throws Error if the number of values is not size().
  template <class T>
  void write(std::span<const T> values) {
    require(values.size() == size_, values.size(), " values given for a tensor of shape ", shape_);
    if (context_->precision() == Precision::f64)
      write_as<double>(values);
    else
      write_as<float>(values);
  }

  /// Downloads all values; waits for the queue.
  template <class T = float>
  std::vector<T> to_host() const {
    return context_->precision() == Precision::f64 ? read_as<double, T>() : read_as<float, T>();
  }

  /// The value of a one-element tensor; waits for the queue. Throws Error for any other size.
  double item() const {
    require(size_ == 1, "item() needs one element, the shape is ", shape_);
    return to_host<double>()[0];
  }

  /// The shape, for messages.
  std::string describe() const { return to_string(shape_); }

 private:
  template <class Stored, class T>
  void write_as(std::span<const T> values) {
    if constexpr (std::is_same_v<Stored, T>) {
      context_->write(buffer(), offset_ * sizeof(T), values.data(), values.size_bytes());
    } else {
      const std::vector<Stored> converted(values.begin(), values.end());
      context_->write(buffer(), offset_ * sizeof(Stored), converted.data(),
                      converted.size() * sizeof(Stored));
    }
  }
  template <class Stored, class T>
  std::vector<T> read_as() const {
    std::vector<Stored> values(size_);
    context_->read(buffer(), offset_ * sizeof(Stored), values.data(), size_ * sizeof(Stored));
    if constexpr (std::is_same_v<Stored, T>)
      return values;
    else
      return std::vector<T>(values.begin(), values.end());
  }

  std::optional<Context> context_;  // empty for a default-constructed tensor
  std::size_t size_ = 0;
  std::shared_ptr<detail::Storage> storage_;
  std::size_t offset_ = 0;
  Shape shape_;
};

/// Integers on the device: word ids, row indices, frame offsets. They remember their range, so that
/// operations can check it without reading from the device.
class Indices {
 public:
  Indices() = default;
  /// Not initialised: write() gives them values; if a kernel does, set_range() gives their range. Throws
  /// Error as Tensor does.
  Indices(const Context& context, std::size_t size)
      : context_(context),
        storage_(detail::allocate_elements(context, {size}, size, sizeof(cl_int))),
        size_(size),
        range_(std::make_shared<Range>()) {}
  Indices(const Context& context, std::span<const cl_int> values) : Indices(context, values.size()) {
    write(values);
  }
  Indices(const Context& context, const std::vector<cl_int>& values)
      : Indices(context, std::span<const cl_int>(values)) {}

  bool empty() const { return storage_ == nullptr; }
  std::size_t size() const { return size_; }
  std::size_t bytes() const { return size_ * sizeof(cl_int); }
  const Context& context() const { return *context_; }
  cl_mem buffer() const { return storage_->buffer(); }
  /// Uploads without waiting for the queue. Throws Error if the number of values is not size().
  void write(std::span<const cl_int> values) {
    require(values.size() == size_, values.size(), " values given for ", size_, " indices");
    context_->write(buffer(), 0, values.data(), values.size_bytes());
    Range range{.known = true};
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (values[i] < values[range.least_at]) range.least_at = i;
      if (values[i] > values[range.most_at]) range.most_at = i;
    }
    if (!values.empty()) range.least = values[range.least_at], range.most = values[range.most_at];
    *range_ = range;
  }

  /// States that all values that a kernel has written lie in least .. most.
  void set_range(cl_int least, cl_int most) {
    *range_ = {.known = true, .drawn = true, .least = least, .most = most};
  }
  /// Throws Error, starting with `operation` and naming the index and its place, unless all values lie in
  /// least .. most.
  void check_range(const char* operation, long long least, long long most) const {
    if (size_ == 0) return;
    const Range& range = *range_;
    require(range.known, operation, ": the indices have no values yet; write() them first");
    if (range.least < least) refuse(operation, range.least, range.least_at, least, most);
    if (range.most > most) refuse(operation, range.most, range.most_at, least, most);
  }

  /// Downloads all values; waits for the queue.
  std::vector<cl_int> to_host() const {
    std::vector<cl_int> values(size_);
    context_->read(buffer(), 0, values.data(), size_ * sizeof(cl_int));
    return values;
  }
  std::string describe() const { return concat("indices[", size_, "]"); }

 private:
  struct Range {
    bool known = false, drawn = false;  // drawn: by a kernel, so that places are not known
    cl_int least = 0, most = 0;
    std::size_t least_at = 0, most_at = 0;
  };

  [[noreturn]] void refuse(const char* operation, cl_int index, std::size_t at, long long least,
                           long long most) const {
    const std::string expected = most < least ? std::string("none") : concat(least, " to ", most);
    if (range_->drawn)
      throw Error(operation, ": indices drawn from ", range_->least, " to ", range_->most, ", expected ",
                  expected);
    throw Error(operation, ": index ", index, " at place ", at, " of ", size_, ", expected ", expected);
  }

  std::optional<Context> context_;
  std::shared_ptr<detail::Storage> storage_;
  std::size_t size_ = 0;
  std::shared_ptr<Range> range_;  // shared like the data
};

namespace detail {
inline void add_argument(KernelArguments& to, const Tensor& tensor) {
  to.set(tensor.buffer());
  add_argument(to, tensor.offset());
}
inline void add_argument(KernelArguments& to, const Indices& indices) { to.set(indices.buffer()); }

/// A tensor from element `first`, as a kernel argument; cheaper than a view.
struct At {
  const Tensor& tensor;
  std::size_t first;
  /// The elements that the kernel touches, for ContextStatistics::bytes_touched; unless set, all that follow.
  std::size_t count = std::numeric_limits<std::size_t>::max();
  std::size_t bytes() const {
    return std::min(count, tensor.size() - std::min(first, tensor.size())) * tensor.context().real_size();
  }
  std::string describe() const { return concat(tensor.describe(), "+", first); }
};
inline void add_argument(KernelArguments& to, const At& at) {
  to.set(at.tensor.buffer());
  add_argument(to, at.tensor.offset() + at.first);
}
}  // namespace detail

}  // namespace motiongan
