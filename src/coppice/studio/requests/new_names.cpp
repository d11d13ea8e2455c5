#include "coppice/studio/requests/new_names_internal.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "coppice/scene/argument.h"

namespace coppice::studio_internal {
namespace {

constexpr std::string_view kOpen = "${new ";
constexpr std::size_t kMaxDigits = 9;  // maximum number of digits at the end of a name that are counted on

std::string free_name(const std::string& wanted, const std::set<std::string>& taken) {
    if (!taken.contains(wanted)) return wanted;
    const std::size_t digits = wanted.find_last_not_of("0123456789") + 1;
    const bool is_counted = digits < wanted.size() && wanted.size() - digits <= kMaxDigits;
    const std::string base = is_counted ? wanted.substr(0, digits) : wanted;
    for (unsigned long n = is_counted ? std::stoul(wanted.substr(digits)) + 1 : 2;; ++n) {
        std::string name = fmt::format("{}{}", base, n);
        if (!taken.contains(name)) return name;
    }
}

}  // namespace

NamedLine with_new_names(std::string_view line, const SceneObjects& objects) {
    std::set<std::string> taken;
    for (const auto& [name, object] : objects) taken.insert(name.second);
    std::map<std::string, std::string, std::less<>> chosen;
    NamedLine out;
    std::size_t done = 0;
    for (std::size_t at = line.find(kOpen); at != line.npos; at = line.find(kOpen, at + 1)) {
        const std::size_t begin = at + kOpen.size();
        const std::size_t end = line.find('}', begin);
        const bool is_escaped = at > 0 && line[at - 1] == '$';
        if (is_escaped || end == line.npos || !is_object_name(line.substr(begin, end - begin))) continue;
        const std::string wanted(line.substr(begin, end - begin));
        if (!chosen.contains(wanted)) {
            out.names.push_back(free_name(wanted, taken));
            taken.insert(out.names.back());
            chosen[wanted] = out.names.back();
        }
        out.line += line.substr(done, at - done);
        out.line += chosen[wanted];
        done = end + 1;
    }
    out.line += line.substr(done);
    return out;
}

}  // namespace coppice::studio_internal
