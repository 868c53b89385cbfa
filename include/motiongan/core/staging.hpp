// Host memory for uploads that do not wait for the queue.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "motiongan/core/driver.hpp"

namespace motiongan::detail {

/// A ring of host buffers; each keeps the data of one upload until its copy has finished. Together they hold
/// at most `limit` bytes: a training step uploads a few KB and never waits for room, a data set of many MB is
/// uploaded once and may wait.
class Staging {
 public:
  static constexpr std::size_t limit = std::size_t{32} << 20;
  /// A buffer above this size is given up for a smaller upload.
  static constexpr std::size_t kept = std::size_t{1} << 20;

  /// Enqueues the copy of `size` bytes to `buffer`; `data` may be reused on return.
  void upload(Driver& driver, cl_command_queue queue, cl_mem buffer, std::size_t offset, const void* data,
              std::size_t size) {
    const auto write = [&](cl_bool waits, const void* from, cl_event* event) {
      driver.check(clEnqueueWriteBuffer(queue, buffer, waits, offset, size, from, 0, nullptr, event),
                   "clEnqueueWriteBuffer", ": ", size, " bytes");
    };
    if (size > limit) return write(CL_TRUE, data, nullptr);
    Slot& slot = slots_[next_];
    next_ = (next_ + 1) % slots_.size();
    wait(driver, slot);
    const std::size_t room = slot.bytes.capacity();
    if (size > room || (room > kept && size <= kept)) make_room(driver, slot, size);
    const auto* first = static_cast<const std::byte*>(data);
    slot.bytes.assign(first, first + size);
    cl_event event = nullptr;
    write(CL_FALSE, slot.bytes.data(), &event);
    slot.copied = ClEvent(event);
  }

  /// Bytes held, whether in use or not.
  std::size_t bytes() const { return bytes_; }

 private:
  struct Slot {
    std::vector<std::byte> bytes;
    ClEvent copied;
  };

  static void wait(Driver& driver, Slot& slot) {
    const ClEvent copied = std::move(slot.copied);  // a failed copy is reported once
    if (!copied) return;
    const cl_event event = copied.get();
    driver.check(clWaitForEvents(1, &event), "clWaitForEvents", ": an upload");
  }

  void release(Slot& slot) {
    bytes_ -= slot.bytes.capacity();
    std::vector<std::byte>().swap(slot.bytes);
  }

  /// Gives `slot`, which is free, `size` bytes; the slots that have waited longest give theirs up for it.
  void make_room(Driver& driver, Slot& slot, std::size_t size) {
    release(slot);
    for (std::size_t i = 0; i < slots_.size() && bytes_ + size > limit; ++i) {
      Slot& oldest = slots_[(next_ + i) % slots_.size()];
      if (oldest.bytes.capacity() == 0) continue;
      wait(driver, oldest);
      release(oldest);
    }
    slot.bytes.reserve(size);
    bytes_ += slot.bytes.capacity();
  }

  std::array<Slot, 64> slots_;
  std::size_t next_ = 0, bytes_ = 0;
};

}  // namespace motiongan::detail
