#pragma once

#include <utility>

namespace coppice {

/// The descriptor of an open file, which is closed on destruction. Closing keeps errno.
class Descriptor {
  public:
    Descriptor() = default;                               ///< none
    explicit Descriptor(int number) : number_(number) {}  ///< takes the ownership; -1: none
    Descriptor(Descriptor&& other) noexcept               ///< takes the ownership
        : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {  ///< takes the ownership; closes the former file
        if (this != &other) {
            close();
            number_ = std::exchange(other.number_, -1);
        }
        return *this;
    }
    ~Descriptor() { close(); }  ///< closes the file

    explicit operator bool() const { return number_ >= 0; }  ///< whether there is an open file
    int get() const { return number_; }                      ///< -1: none
    int release() { return std::exchange(number_, -1); }     ///< transfers the ownership to the caller
    void close();                                            ///< closes the file, if there is one

  private:
    int number_ = -1;
};

}  // namespace coppice
