#include "studio/cli/option_tree.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/text.h"

namespace underbody::studio {

namespace {

/// Of a description such as "C: double | float | fixed (whole numbers)" or "up: lift positive up | ned: body axes".
std::vector<std::string> described_choices(const std::string& description) {
    const auto parts = core::split(description, '|');
    std::vector<std::string> choices;
    for (std::size_t i = 0; i < parts.size() && parts.size() > 1; ++i) {
        const auto words = core::split(core::trimmed(parts[i]), ' ');
        const auto is_word = [](std::string_view word) {
            return !word.empty() && word.find_first_not_of("abcdefghijklmnopqrstuvwxyz_-") == std::string_view::npos;
        };
        std::string_view word = words.front();
        word = word.substr(0, word.find_first_of(":,"));
        // What the first is a choice of may stand before it.
        if (i == 0 && words.size() > 1 && !(is_word(word) && words.front().ends_with(':'))) {
            word = words.back();
        }
        if (!is_word(word)) {
            return {};
        }
        choices.emplace_back(word);
    }
    return choices;
}

/// Of a check such as {automatic,file,reversed}, or those that the description names.
std::vector<std::string> choices_of(const CLI::Option& option) {
    std::vector<std::string> choices;
    const std::string type = option.get_type_name();
    const std::size_t open = type.find('{');
    const std::size_t close = type.find('}');
    if (open == std::string::npos || close == std::string::npos) {
        return described_choices(option.get_description());
    }
    for (std::size_t begin = open + 1; begin < close;) {
        const std::size_t end = std::min(type.find(',', begin), close);
        choices.push_back(type.substr(begin, end - begin));
        begin = end + 1;
    }
    return choices;
}

nlohmann::json option_of(const CLI::Option& option) {
    nlohmann::json json = {{"description", option.get_description()},
                           {"required", option.get_required()},
                           {"several", option.get_expected_max() > 1},
                           {"default", option.get_default_str()}};
    if (option.get_positional()) {
        json["name"] = option.get_name(true, false);
        return json;
    }
    const std::string type = option.get_type_name();
    json["flag"] = option.get_expected_max() == 0;
    json["kind"] = type.starts_with("INT") || type.starts_with("UINT") || type.starts_with("FLOAT") ? "number" : "text";
    json["choices"] = choices_of(option);
    json["names"] = nlohmann::json::array();
    for (const auto& name : option.get_lnames()) {
        json["names"].push_back("--" + name);
    }
    for (const auto& name : option.get_snames()) {
        json["names"].push_back("-" + name);
    }
    return json;
}

}  // namespace

nlohmann::json option_tree(const CLI::App& app) {
    nlohmann::json json = {{"name", app.get_name()},
                           {"description", app.get_description()},
                           {"examples", app.get_footer()},
                           {"needs_command", app.get_require_subcommand_min() > 0},
                           {"positionals", nlohmann::json::array()},
                           {"options", nlohmann::json::array()},
                           {"commands", nlohmann::json::array()}};
    for (const auto* option : app.get_options()) {
        if (!option->get_group().empty()) {
            json[option->get_positional() ? "positionals" : "options"].push_back(option_of(*option));
        }
    }
    for (const auto* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        if (!command->get_group().empty()) {
            json["commands"].push_back(option_tree(*command));
        }
    }
    return json;
}

}  // namespace underbody::studio
