// underbody completion SHELL: what the Tab key completes, from the commands and options that there are.
#include <CLI/CLI.hpp>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studio/cli/commands.h"
#include "studio/cli/option_tree.h"
#include "studio/cli/shell.h"

namespace underbody::studio {

namespace {

/// Calls `visit` with every command: its words ("underbody table at") and its part of the tree.
void each_command(const nlohmann::json& tree, const std::string& words,
                  const std::function<void(const std::string&, const nlohmann::json&)>& visit) {
    visit(words, tree);
    for (const auto& command : tree["commands"]) {
        each_command(command, words + " " + command["name"].get<std::string>(), visit);
    }
}

/// In single quotes of a shell; the first line alone.
std::string quoted(std::string text, const std::string& apostrophe) {
    text = text.substr(0, text.find('\n'));
    std::string result;
    for (const char c : text) {
        result += c == '\'' ? apostrophe : std::string(1, c);
    }
    return "'" + result + "'";
}

std::string joined(const nlohmann::json& names) {
    std::string text;
    for (const auto& name : names) {
        text += (text.empty() ? "" : " ") + name.get<std::string>();
    }
    return text;
}

/// Options of a command and those that stand with every command.
std::vector<nlohmann::json> options_of(const nlohmann::json& root, const nlohmann::json& tree) {
    std::vector<nlohmann::json> all(tree["options"].begin(), tree["options"].end());
    if (tree["name"] != root["name"]) {
        for (const auto& option : root["options"]) {
            const auto& name = option["names"].front();
            if (name != "--version" && name != "--help") {
                all.push_back(option);
            }
        }
    }
    return all;
}

/// "a"|"b" of the paths of all sub-commands: where the walk along the words goes deeper.
std::string deeper(const nlohmann::json& root) {
    std::string paths;
    each_command(root, "underbody", [&](const std::string& words, const nlohmann::json& tree) {
        paths += tree["name"] == root["name"] ? "" : (paths.empty() ? "\"" : "|\"") + words + "\"";
    });
    return paths;
}

/// `case` branches: words of the command -> what `branch` says of it.
std::string branches(const nlohmann::json& root, const std::function<std::string(const nlohmann::json&)>& branch) {
    std::string text;
    each_command(root, "underbody", [&](const std::string& words, const nlohmann::json& tree) {
        text += "        \"" + words + "\")\n" + branch(tree) + "            ;;\n";
    });
    return text;
}

/// Branches "words --option" -> `line` with its choices.
std::string choices(const nlohmann::json& root, const std::string& before, const std::string& after) {
    std::string text;
    each_command(root, "underbody", [&](const std::string& words, const nlohmann::json& tree) {
        for (const auto& option : tree["options"]) {
            if (!option["choices"].empty()) {
                for (const auto& name : option["names"]) {
                    text += "        \"" + words + " " + name.get<std::string>() + "\") " + before +
                            joined(option["choices"]) + after + " ;;\n";
                }
            }
        }
    });
    return text;
}

std::string bash(const nlohmann::json& root) {
    return "# bash completion of underbody, made by 'underbody completion bash'\n"
           "_underbody() {\n"
           "    local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} at=underbody i commands= "
           "options=\n"
           "    COMPREPLY=()\n"
           "    for ((i = 1; i < COMP_CWORD; i++)); do\n"
           "        case \"$at ${COMP_WORDS[i]}\" in\n"
           "        " +
           deeper(root) +
           ") at=\"$at ${COMP_WORDS[i]}\" ;;\n"
           "        esac\n"
           "    done\n"
           "    case \"$at $prev\" in\n" +
           choices(root, "COMPREPLY=($(compgen -W \"", "\" -- \"$cur\")); return") +
           "    esac\n"
           "    case \"$at\" in\n" +
           branches(root,
                    [&](const nlohmann::json& tree) {
                        std::string names, options;
                        for (const auto& command : tree["commands"]) {
                            names += (names.empty() ? "" : " ") + command["name"].get<std::string>();
                        }
                        for (const auto& option : options_of(root, tree)) {
                            options += (options.empty() ? "" : " ") + joined(option["names"]);
                        }
                        return "            commands=\"" + names + "\"\n            options=\"" + options + "\"\n";
                    }) +
           "    esac\n"
           "    if [[ $cur == -* ]]; then\n"
           "        COMPREPLY=($(compgen -W \"$options\" -- \"$cur\"))\n"
           "    else\n"
           "        COMPREPLY=($(compgen -W \"$commands\" -- \"$cur\") $(compgen -f -- \"$cur\"))\n"
           "    fi\n"
           "}\n"
           "complete -o filenames -o bashdefault -F _underbody underbody\n";
}

std::string zsh(const nlohmann::json& root) {
    return "#compdef underbody\n"
           "# zsh completion of underbody, made by 'underbody completion zsh'\n"
           "_underbody() {\n"
           "    local at=underbody word prev=${words[CURRENT-1]}\n"
           "    local -a commands options\n"
           "    for word in ${words[2,CURRENT-1]}; do\n"
           "        case \"$at $word\" in\n"
           "        " +
           deeper(root) +
           ") at=\"$at $word\" ;;\n"
           "        esac\n"
           "    done\n"
           "    case \"$at $prev\" in\n" +
           choices(root, "compadd -- ", "; return") +
           "    esac\n"
           "    case \"$at\" in\n" +
           branches(root,
                    [&](const nlohmann::json& tree) {
                        const auto entry = [](const std::string& name, const nlohmann::json& one) {
                            return " " + quoted(name + ":" + one["description"].get<std::string>(), "'\\''");
                        };
                        std::string names, options;
                        for (const auto& command : tree["commands"]) {
                            names += entry(command["name"], command);
                        }
                        for (const auto& option : options_of(root, tree)) {
                            for (const auto& name : option["names"]) {
                                options += entry(name, option);
                            }
                        }
                        return "            commands=(" + names + ")\n            options=(" + options + ")\n";
                    }) +
           "    esac\n"
           "    if [[ ${words[CURRENT]} == -* ]]; then\n"
           "        _describe -o option options\n"
           "    else\n"
           "        (( $#commands )) && _describe command commands\n"
           "        _files\n"
           "    fi\n"
           "}\n"
           "if [ \"$funcstack[1]\" = _underbody ]; then _underbody \"$@\"; else compdef _underbody underbody; fi\n";
}

std::string fish(const nlohmann::json& root) {
    std::string text =
        "# fish completion of underbody, made by 'underbody completion fish'\n"
        "function __underbody_at\n"
        "    set -l at underbody\n"
        "    for word in (commandline -opc)[2..-1]\n"
        "        switch \"$at $word\"\n"
        "            case ";
    each_command(root, "underbody", [&](const std::string& words, const nlohmann::json& tree) {
        text += tree["name"] == root["name"] ? "" : " '" + words + "'";
    });
    text +=
        "\n"
        "                set at \"$at $word\"\n"
        "        end\n"
        "    end\n"
        "    test \"$at\" = \"$argv[1]\"\n"
        "end\n";
    each_command(root, "underbody", [&](const std::string& words, const nlohmann::json& tree) {
        const std::string here = "complete -c underbody -n \"__underbody_at '" + words + "'\"";
        for (const auto& command : tree["commands"]) {
            text += here + " -a " + command["name"].get<std::string>() + " -d " +
                    quoted(command["description"], "\\'") + "\n";
        }
        for (const auto& option : options_of(root, tree)) {
            text += here;
            for (const auto& name : option["names"]) {
                const std::string word = name;
                text += word.starts_with("--") ? " -l " + word.substr(2) : " -s " + word.substr(1);
            }
            text += option["flag"].get<bool>() ? "" : " -r";
            text += option["choices"].empty() ? "" : " -f -a '" + joined(option["choices"]) + "'";
            text += " -d " + quoted(option["description"], "\\'") + "\n";
        }
    });
    return text;
}

}  // namespace

void add_completion_command(CLI::App& app, Shell& shell) {
    CLI::App* command = app.add_subcommand("completion", "what the Tab key completes, for bash, zsh or fish");
    auto kind = std::make_shared<std::string>();
    command->add_option("shell", *kind, "bash, zsh or fish")->required()->check(CLI::IsMember({"bash", "zsh", "fish"}));
    command->footer(
        "Debian's package installs them. By hand:\n"
        "  source <(underbody completion bash)                                             this bash\n"
        "  underbody completion zsh > ~/.zsh/_underbody                                    a folder of zsh's fpath\n"
        "  underbody completion fish > ~/.config/fish/completions/underbody.fish");
    shell.on(command, [kind, &app, &shell] {
        const nlohmann::json tree = option_tree(app);
        const std::string text = *kind == "bash" ? bash(tree) : *kind == "zsh" ? zsh(tree) : fish(tree);
        shell.print(text);
        if (shell.json) {
            shell.print_json({{"shell", *kind}, {"script", text}});
        }
        return static_cast<int>(done);
    });
}

}  // namespace underbody::studio
