// An array that is not filled before it is read into, and that VTK can take over without a copy.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace underbody::postproc {

/// Memory that free() gives back, not filled. Much of it comes in huge pages where the system has them: taking an array
/// page by page costs several times what reading a file into it does. Throws std::bad_alloc.
[[nodiscard]] void* take_memory(std::size_t bytes);

/// Numbers of trivial type; new elements are NOT initialised. `release` hands out memory that free() gives back.
template <typename T>
class Buffer {
    static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);

public:
    Buffer() = default;
    explicit Buffer(std::size_t size) { grow_to(size); }
    Buffer(Buffer&& other) noexcept
        : data_(std::move(other.data_)), size_(std::exchange(other.size_, 0)), room_(std::exchange(other.room_, 0)) {}
    Buffer& operator=(Buffer&& other) noexcept {
        data_ = std::move(other.data_);
        size_ = std::exchange(other.size_, 0);
        room_ = std::exchange(other.room_, 0);
        return *this;
    }

    /// Keeps what is there; memory grows to exactly `size` (use `push` for growth by and by).
    void grow_to(std::size_t size) {
        if (size > room_) {
            move_to(size);
        }
        size_ = size;
    }
    void push(T value) {
        if (size_ == room_) {
            move_to(std::max<std::size_t>(64, room_ + room_ / 2));
        }
        data_[size_++] = value;
    }
    void fill(T value) { std::fill_n(data_.get(), size_, value); }
    void clear() { *this = Buffer(); }

    [[nodiscard]] T* release() {
        size_ = 0;
        room_ = 0;
        return data_.release();
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] bool empty() const { return size_ == 0; }
    [[nodiscard]] T* data() { return data_.get(); }
    [[nodiscard]] const T* data() const { return data_.get(); }
    T& operator[](std::size_t i) { return data_[i]; }
    const T& operator[](std::size_t i) const { return data_[i]; }
    [[nodiscard]] T* begin() { return data_.get(); }
    [[nodiscard]] T* end() { return data_.get() + size_; }
    [[nodiscard]] const T* begin() const { return data_.get(); }
    [[nodiscard]] const T* end() const { return data_.get() + size_; }

private:
    struct Free {
        void operator()(T* memory) const { std::free(memory); }
    };
    using Memory = std::unique_ptr<T[], Free>;

    void move_to(std::size_t room) {
        if (room > SIZE_MAX / sizeof(T)) {
            throw std::bad_alloc();
        }
        Memory larger(static_cast<T*>(take_memory(room * sizeof(T))));
        std::copy_n(data_.get(), size_, larger.get());
        data_ = std::move(larger);
        room_ = room;
    }

    Memory data_;
    std::size_t size_ = 0;
    std::size_t room_ = 0;
};

}  // namespace underbody::postproc
