#include "studio/cli/usage.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <vector>

#include "core/text.h"

namespace underbody::studio {

namespace {

/// The commands as typed, from the program to the innermost one.
std::vector<const CLI::App*> chain_of(const CLI::App& app) {
    std::vector<const CLI::App*> chain = {&app};
    while (true) {
        const auto inner = chain.back()->get_subcommands();
        if (inner.empty()) {
            return chain;
        }
        chain.push_back(inner.back());
    }
}

std::string name_of(const std::vector<const CLI::App*>& chain) {
    std::string name;
    for (const auto* app : chain) {
        name += (name.empty() ? "" : " ") + app->get_name();
    }
    return name;
}

/// Long and short names, with their dashes, of the options that may stand at the end of the chain.
std::vector<std::string> options_of(const std::vector<const CLI::App*>& chain) {
    std::vector<std::string> names;
    for (auto app = chain.rbegin(); app != chain.rend(); ++app) {
        for (const auto* option : (*app)->get_options()) {
            for (const auto& name : option->get_lnames()) {
                names.push_back("--" + name);
            }
            for (const auto& name : option->get_snames()) {
                names.push_back("-" + name);
            }
        }
    }
    return names;
}

std::vector<std::string> commands_of(const CLI::App& app) {
    std::vector<std::string> names;
    for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
    }
    return names;
}

/// The nearest name; of several letters that begin one option, that option.
std::string nearest(const std::string& word, const std::vector<std::string>& names) {
    std::string found = core::nearest_name(word, names);
    if (found.empty() && word.size() > 3) {
        const auto longer =
            std::find_if(names.begin(), names.end(), [&](const std::string& name) { return name.starts_with(word); });
        found = longer == names.end() ? std::string() : *longer;
    }
    return found;
}

/// "Value -3 not in range 0.000000 to 1797..." where only one end is meant, in words; others as they are.
std::string range_in_words(const std::string& complaint) {
    constexpr std::string_view words = " not in range ";
    const auto at = complaint.find(words);
    const auto to = complaint.find(" to ", at == std::string::npos ? at : at + words.size());
    if (to == std::string::npos) {
        return complaint;
    }
    const auto lower = core::parse_number(complaint.substr(at + words.size(), to - at - words.size()));
    const auto upper = core::parse_number(complaint.substr(to + 4));
    constexpr double endless = 1e300;
    if (!lower || !upper || *upper < endless) {
        return complaint;
    }
    const auto value = core::parse_number(complaint.substr(0, at).substr(complaint.rfind(' ', at - 1) + 1));
    const bool at_the_end = value && *value >= *lower;  // the least of all positive numbers is written as 0
    return complaint.substr(0, at) + (at_the_end ? " is not above " : " is below ") + core::format_number(*lower);
}

/// "format is required" with what the option is.
std::string with_meaning(const CLI::App& command, const std::string& complaint) {
    constexpr std::string_view words = " is required";
    if (!complaint.ends_with(words)) {
        return complaint;
    }
    const auto* option = command.get_option_no_throw(complaint.substr(0, complaint.size() - words.size()));
    return option == nullptr || option->get_description().empty() ? complaint
                                                                  : complaint + ": " + option->get_description();
}

}  // namespace

core::UsageError usage_error(const CLI::App& app, const CLI::ParseError& complaint) {
    const auto chain = chain_of(app);
    const std::string command = name_of(chain);
    const std::string help = command + " --help";
    const auto left = app.remaining(true);
    const auto option = std::find_if(left.begin(), left.end(), [](const std::string& word) {
        return word.size() > 1 && word.front() == '-' && word != "--";
    });
    if (option != left.end()) {
        const std::string word = option->substr(0, option->find('='));
        const std::string near = nearest(word, options_of(chain));
        return {
            "usage", "'" + command + "' has no option " + word, {}, near.empty() ? help : "did you mean " + near + "?"};
    }
    const auto commands = commands_of(*chain.back());
    if (!left.empty() && !commands.empty()) {
        const std::string near = nearest(left.front(), commands);
        return {"usage",
                "'" + command + "' has no command '" + left.front() + "'",
                {},
                near.empty() ? help : "did you mean '" + command + " " + near + "'?"};
    }
    return {"usage", range_in_words(with_meaning(*chain.back(), complaint.what())), {}, help};
}

}  // namespace underbody::studio
