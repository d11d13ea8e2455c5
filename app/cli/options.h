#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "coppice/base/error.h"
#include "coppice/pipeline/option_fields.h"

namespace coppice::cli {

/// The command line itself is wrong: exit code 2.
class UsageError : public Error {
  public:
    using Error::Error;
};

/// Where what follows an option is stored: a file, files, or the member of an option struct.
using OptionTarget = std::variant<std::filesystem::path*, std::vector<std::filesystem::path>*, bool*, int*,
                                  float*, ChoiceRef, std::optional<Vec3d>*, std::vector<std::string>*>;

/// One option of a command: all that the parser, the help and the schema know of it.
struct Option {
    std::string name;    ///< "--output"; a file that needs no flag before it has no dashes: "input"
    std::string letter;  ///< "-o", or none
    std::string help;    ///< one sentence without a full stop, which the help adds
    std::string type;    ///< what the value is called in the help: "FILE"; none for a switch
    std::string group;   ///< heading in the help; none stands first
    std::string field;   ///< path of the member that it sets: "project.method"; none for others
    Unit unit = Unit::none;
    double low = 0, high = 0;  ///< of numbers, both included, where low < high
    bool common = true;        ///< shown by --help, not only by --help-all
    bool is_output = false;    ///< names files that are written
    std::string replaces;      ///< of outputs: the option with the input that may be overwritten, or none
    OptionTarget target;
};

/// Members of an option struct by their paths, as "restore.reach".
using MemberNames = std::vector<std::string_view>;

/// How the members of an option struct are called on the command line where not after themselves, as
/// wire_width is --wire-width.
struct FlagNames {
    std::string_view prefix;  ///< goes before all of them: "b" makes --b-scale
    std::vector<std::pair<std::string_view, std::string_view>>
        names;            ///< {"restore.reach", "--restore-reach"}
    MemberNames without;  ///< members that get no option
    /// Members that --help shows; without a value those that the fields mark as common.
    std::optional<MemberNames> common = std::nullopt;
};

/// Where the help shows an option that belongs to no option struct.
struct HelpPlace {
    std::string group = {};  ///< see Option
    bool common = true;      ///< see Option
};

/// The options of one command, in the order of its help. Every name is declared once: one that is taken
/// already is an error of the program, told at its start.
class OptionList {
  public:
    /// "input" or "-o,--output"; `type` is what the help calls the file.
    void file(const std::string& names, const std::string& type, std::filesystem::path& target,
              const std::string& help, const HelpPlace& place = {});
    /// The same for files: after a flag that may be repeated, or as many as there are.
    void files(const std::string& names, const std::string& type, std::vector<std::filesystem::path>& target,
               const std::string& help, const HelpPlace& place = {});
    /// The same for files that are written; see check_outputs().
    void output(const std::string& names, const std::string& type, std::filesystem::path& target,
                const std::string& help, const HelpPlace& place = {});
    void outputs(const std::string& names, const std::string& type,
                 std::vector<std::filesystem::path>& target, const std::string& help,
                 const HelpPlace& place = {});
    /// Lets an output of this name overwrite the file that the option `input` names.
    void may_replace(const std::string& output, const std::string& input);
    /// Off unless given.
    void flag(const std::string& names, bool& target, const std::string& help, const HelpPlace& place = {});
    /// One value that belongs to no option struct.
    void value(const OptionField& field, const std::string& group = {});

    /// An option for every member of an option struct; the members of a struct within it stand under a
    /// heading of their own. Parsing stores into the struct, so it must live as long.
    template <OptionStruct Options>
    void fields(Options& options, const std::string& group, const FlagNames& names = {}) {
        add_fields(option_fields(options), group, {}, names);
    }

    std::span<const Option> all() const { return options_; }

  private:
    Option& add(Option option, const std::string& names);
    void add_fields(std::span<const OptionField> fields, const std::string& group, const std::string& path,
                    const FlagNames& names);

    std::vector<Option> options_;
};

/// wire_width -> --wire-width
std::string flag_name(std::string_view field_name);

/// Stores what a word on the command line says. Throws UsageError naming the option and what it takes. Not
/// for switches.
void store(const Option& option, const std::string& word);

/// A text as a sentence of the help: with a capital and a full stop.
std::string sentence(std::string text);

/// The help of an option, a sentence with its unit, range and default.
std::string help_text(const Option& option);

}  // namespace coppice::cli
