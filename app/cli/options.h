#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/base/option_fields.h"

namespace coppice::cli {

/// An invalid command line: exit code 2.
class UsageError : public Error {
  public:
    using Error::Error;
};

/// Storage of the value of an option: a file, files, or the member of an option struct.
using OptionTarget = std::variant<std::filesystem::path*, std::vector<std::filesystem::path>*, bool*, int*,
                                  float*, ChoiceRef, std::optional<Vec3d>*, std::vector<std::string>*>;

/// One option of a command, as used by the parser, the help and the schema.
struct Option {
    std::string name;    ///< "--output"; a positional file has no dashes: "input"
    std::string letter;  ///< "-o", or empty
    std::string help;    ///< one sentence
    std::string type;    ///< name of the value in the help: "FILE"; empty for a switch
    std::string group;   ///< heading in the help; options without one come first
    std::string field;   ///< path of the member that it sets: "project.method"; empty for others
    Unit unit = Unit::none;
    double low = 0, high = 0;           ///< inclusive range of numbers, if low < high
    bool common = true;                 ///< shown by --help, not only by --help-all
    bool is_output = false;             ///< names files that are written
    std::vector<std::string> replaces;  ///< of outputs: the options with inputs that may be overwritten
    OptionTarget target;
};

/// Members of an option struct by their paths, such as "restore.reach".
using MemberNames = std::vector<std::string_view>;

/// Flags of the members of an option struct where they differ from the default; by default wire_width is
/// --wire-width.
struct FlagNames {
    std::string_view prefix;  ///< prefix of all flags: "b" makes --b-scale
    std::vector<std::pair<std::string_view, std::string_view>>
        names;            ///< {"restore.reach", "--restore-reach"}
    MemberNames without;  ///< members without an option
    /// Members that --help shows; if not set, those that the fields mark as common.
    std::optional<MemberNames> common = std::nullopt;
};

/// Placement in the help of an option that does not belong to an option struct.
struct HelpPlace {
    std::string group = {};  ///< see Option
    bool common = true;      ///< see Option
};

/// The options of one command, in the order of its help. Every name is declared once; a duplicate is an error
/// of the program that is reported at its start.
class OptionList {
  public:
    /// "input" or "-o,--output"; `type` is the name of the file in the help.
    void file(const std::string& names, const std::string& type, std::filesystem::path& target,
              const std::string& help, const HelpPlace& place = {});
    /// The same for several files: a flag that may be repeated, or any number of positional files.
    void files(const std::string& names, const std::string& type, std::vector<std::filesystem::path>& target,
               const std::string& help, const HelpPlace& place = {});
    /// The same for files that are written; see check_outputs().
    void output(const std::string& names, const std::string& type, std::filesystem::path& target,
                const std::string& help, const HelpPlace& place = {});
    void outputs(const std::string& names, const std::string& type,
                 std::vector<std::filesystem::path>& target, const std::string& help,
                 const HelpPlace& place = {});
    /// Allows an output of this name to overwrite the file that the option `input` names.
    void may_replace(const std::string& output, const std::string& input);
    /// A switch that is off by default.
    void flag(const std::string& names, bool& target, const std::string& help, const HelpPlace& place = {});
    /// One value that does not belong to an option struct.
    void value(const OptionField& field, const std::string& group = {});

    /// Adds an option for every member of an option struct; the members of a nested struct have a heading of
    /// their own. Parsing stores into the struct, so it must outlive the list.
    template <OptionStruct Options>
    void fields(Options& options, const std::string& group, const FlagNames& names = {}) {
        add_struct(option_fields(options), group, names);
    }

    std::span<const Option> all() const { return options_; }

  private:
    Option& add(Option option, const std::string& names);
    void add_struct(std::span<const OptionField> fields, const std::string& group, const FlagNames& names);
    void add_fields(std::span<const OptionField> fields, const std::string& group, const std::string& path,
                    const FlagNames& names);

    std::vector<Option> options_;
};

/// The options that were given on the command line.
using GivenOptions = std::vector<const Option*>;

/// Returns whether an option is given.
bool is_given(const GivenOptions& given, std::string_view name);
/// Returns the first given option that belongs to one of the groups; null if there is none.
const Option* first_of_groups(const GivenOptions& given, std::initializer_list<std::string_view> groups);

/// Copies the values of the given options from one option struct to another one of the same type, as the
/// options of a species that the command line changes.
void copy_given(std::span<const OptionField> from, std::span<const OptionField> to,
                const GivenOptions& given);

/// Converts errors of the library that the command line causes to UsageError, with a prefix.
template <class Work>
auto as_usage(std::string_view prefix, const Work& work) {
    try {
        return work();
    } catch (const InvalidInput& error) {
        throw UsageError(std::string(prefix) + error.what());
    }
}

/// wire_width -> --wire-width
std::string flag_name(std::string_view field_name);

/// Stores a word of the command line in an option that is not a switch. Throws UsageError with the name of
/// the option and the values that it accepts.
void store(const Option& option, const std::string& word);

/// Returns the help of an option: a sentence with its unit, range and default.
std::string help_text(const Option& option);

}  // namespace coppice::cli
