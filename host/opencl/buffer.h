#pragma once

#include "opencl/device.h"

#include <cstddef>
#include <string>
#include <vector>

namespace tristim {

/// A typed device buffer that knows its name (for messages and --stats) and its size. OpenCL buffers may not be empty,
/// so a buffer of zero elements holds one.
template <typename T>
class Buffer {
  public:
    Buffer() = default;

    /// Uninitialised storage. Throws Error naming the buffer and its size if the device has no room.
    Buffer(const Device& device, std::string name, std::size_t count);

    /// Storage with the contents of `data`.
    Buffer(const Device& device, std::string name, const std::vector<T>& data);

    std::size_t size() const { return count_; }
    std::size_t bytes() const { return count_ * sizeof(T); }
    const std::string& name() const { return name_; }
    const ::cl::Buffer& cl() const { return buffer_; }

    /// Blocking copies of the whole buffer or its first `count` elements.
    std::vector<T> read(const Device& device) const { return read(device, count_); }
    std::vector<T> read(const Device& device, std::size_t count) const;
    void write(const Device& device, const std::vector<T>& data) const;

    /// Sets every byte-pattern element to `value` (enqueued, not blocking).
    void fill(const Device& device, const T& value) const;

    /// Copies element `from` to element `to` of another buffer (enqueued, not blocking).
    void copy_element(const Device& device, std::size_t from, const Buffer& other, std::size_t to) const;

  private:
    std::string name_;
    std::size_t count_ = 0;
    ::cl::Buffer buffer_;
};

/// Allocates or throws an Error that names the buffer; the untyped part of Buffer.
::cl::Buffer allocate_device_memory(const Device& device, const std::string& name, std::size_t bytes);

template <typename T>
Buffer<T>::Buffer(const Device& device, std::string name, std::size_t count)
    : name_(std::move(name)), count_(count),
      buffer_(allocate_device_memory(device, name_, sizeof(T) * (count > 0 ? count : 1))) {}

template <typename T>
Buffer<T>::Buffer(const Device& device, std::string name, const std::vector<T>& data)
    : Buffer(device, std::move(name), data.size()) {
    write(device, data);
}

template <typename T>
std::vector<T> Buffer<T>::read(const Device& device, std::size_t count) const {
    std::vector<T> data(count);
    device.before(DeviceCall::Copy);
    if (count > 0)
        device.queue.enqueueReadBuffer(buffer_, CL_TRUE, 0, count * sizeof(T), data.data());
    return data;
}

template <typename T>
void Buffer<T>::write(const Device& device, const std::vector<T>& data) const {
    device.before(DeviceCall::Copy);
    if (!data.empty())
        device.queue.enqueueWriteBuffer(buffer_, CL_TRUE, 0, data.size() * sizeof(T), data.data());
}

template <typename T>
void Buffer<T>::fill(const Device& device, const T& value) const {
    device.before(DeviceCall::Copy);
    device.queue.enqueueFillBuffer(buffer_, value, 0, sizeof(T) * (count_ > 0 ? count_ : 1));
}

template <typename T>
void Buffer<T>::copy_element(const Device& device, std::size_t from, const Buffer& other, std::size_t to) const {
    device.before(DeviceCall::Copy);
    device.queue.enqueueCopyBuffer(buffer_, other.buffer_, from * sizeof(T), to * sizeof(T), sizeof(T));
}

} // namespace tristim
