#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coppice::e57 {

/// The bytes of an E57 file without the checksums, CRC-32C, that end each of its pages of 1024 bytes.
class Pages {
  public:
    /// `file` must outlive this. What follows the last whole page is no part of it.
    Pages(std::string_view file, const std::string& source);

    std::uint64_t size() const { return pages_ * kContent; }  ///< [bytes] without checksums

    /// Where a byte of the file is among those without checksums. Throws InvalidInput where it is a checksum.
    std::uint64_t logical(std::uint64_t physical) const;

    /// Bytes from `at` on, without checksums. Throws InvalidInput where they are not all there, or a page
    /// that they lie in has another checksum than it says.
    std::string read(std::uint64_t at, std::uint64_t size);

  private:
    static constexpr std::uint64_t kPage = 1024, kContent = 1020;  // [bytes]

    std::string_view content(std::uint64_t page);

    std::string_view file_;
    const std::string& source_;
    std::uint64_t pages_;
    std::vector<bool> checked_;
};

}  // namespace coppice::e57
