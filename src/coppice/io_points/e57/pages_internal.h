#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace coppice::e57 {

/// The bytes of an E57 file without the CRC-32C checksum at the end of each 1024-byte page.
class Pages {
  public:
    /// `file` must outlive this object. Bytes after the last whole page are ignored.
    Pages(std::string_view file, const std::string& source);

    std::uint64_t size() const { return pages_ * kContent; }  ///< [bytes] without checksums

    /// Converts a file offset to an offset without checksums. Throws InvalidInput if it refers to a checksum.
    std::uint64_t logical(std::uint64_t physical) const;

    /// Returns bytes from `at` on, without checksums. Throws InvalidInput if the file ends before them, or
    /// the checksum of one of their pages does not match.
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
