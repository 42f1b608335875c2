#include "studio/cli/shell.h"

#include <sys/stat.h>
#include <unistd.h>
#include <vtkPolyData.h>
#include <vtkUnstructuredGrid.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string_view>
#include <utility>

#include "core/own_files.h"
#include "core/parallel.h"
#include "core/table.h"
#include "postproc/field/import_error.h"
#include "studio/cli/caller.h"
#include "studio/cli/option_words.h"
#include "studio/cli/usage.h"

namespace underbody::studio {

namespace {

core::Progress* watched = nullptr;

extern "C" void on_interrupt(int) {
    if (watched != nullptr) {
        if (watched->cancelled()) {
            std::_Exit(cancelled);  // the second Ctrl-C does not wait
        }
        watched->cancel();
    }
}

/// A bar on a terminal, at most ten times a second.
class Bar {
public:
    void operator()(double fraction, const std::string& what) {
        const std::lock_guard lock(mutex_);
        const auto now = std::chrono::steady_clock::now();
        if (now - last_ < std::chrono::milliseconds(100) && fraction < 1) {
            return;
        }
        last_ = now;
        std::fprintf(stderr, "\r\033[K%3.0f%% %s", 100 * fraction, what.substr(0, 70).c_str());
        if (fraction >= 1) {
            std::fprintf(stderr, "\r\033[K");
        }
    }

private:
    std::mutex mutex_;
    std::chrono::steady_clock::time_point last_;
};

core::Progress::Listener listener(const bool& quiet) {
    if (::isatty(2) == 0) {
        return {};
    }
    auto bar = std::make_shared<Bar>();
    return [bar, &quiet](double fraction, const std::string& what) {
        if (!quiet) {
            (*bar)(fraction, what);
        }
    };
}

}  // namespace

Shell::Shell() : progress_(listener(quiet)) {}

Shell::Shell(Caller& caller, core::Progress::Listener listener)
    : json(true), caller_(&caller), progress_(std::move(listener)) {}

void Shell::on(CLI::App* command, std::function<int()> action) {
    command->callback([this, action = std::move(action)] { action_ = action; });
}

namespace {

// NaN has no place in JSON: nlohmann writes null for it. Names of files may be of any bytes.
std::string dumped(const nlohmann::json& document, int indent) {
    return document.dump(indent, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Whether the sentence is a text of the document or a part of one.
bool holds(const std::string& document, const std::string& sentence) {
    const std::string quoted = dumped(sentence, -1);
    return document.find(quoted.substr(1, quoted.size() - 2)) != std::string::npos;
}

/// The document with these sentences in its `warnings`, as texts or, where it has objects there, as objects.
nlohmann::json with_warnings(nlohmann::json document, const std::vector<std::string>& sentences) {
    auto& warnings = document["warnings"];
    const bool objects = warnings.is_array() && !warnings.empty() && warnings.front().is_object();
    for (const std::string& one : sentences) {
        warnings.push_back(objects ? nlohmann::json{{"message", one}} : nlohmann::json(one));
    }
    return document;
}

}  // namespace

void Shell::print_json(const nlohmann::json& document) {
    std::string text = dumped(document, 2);
    if (document.is_object() && !document.contains("error")) {
        std::vector<std::string> missing;
        for (const Warning& one : std::exchange(undocumented_, {})) {
            if (!holds(text, one.message)) {
                missing.push_back(with_flags(one.text));
            }
        }
        if (!missing.empty()) {
            text = dumped(with_warnings(document, missing), 2);
        }
        documented();
    }
    if (caller_ != nullptr) {
        caller_->document = std::move(text);
    } else {
        std::cout << text << '\n';
    }
}

void Shell::print(const std::string& text) {
    if (!json) {
        const std::string lines = with_flags(text) + (text.ends_with('\n') ? "" : "\n");
        all_or_nothing ? void(text_ += lines) : void(std::cout << lines);
    }
}

void Shell::say(int level, const std::string& text) {
    if (caller_ != nullptr) {
        caller_->remarks.emplace_back(static_cast<Caller::Level>(level), with_flags(text));
    } else {
        std::cerr << (level == static_cast<int>(Caller::Level::warning) ? "underbody: warning: " : "underbody: ")
                  << with_flags(text) << '\n';
    }
}

void Shell::warn(const std::string& text) { say(static_cast<int>(Caller::Level::warning), text); }

void Shell::info(const std::string& text) {
    if (!quiet) {
        say(static_cast<int>(Caller::Level::info), text);
    }
}

void Shell::detail(const std::string& text) {
    if (verbose || caller_ != nullptr) {
        say(static_cast<int>(Caller::Level::detail), text);
    }
}

namespace {
/// The same values in data sets of their own: who adds or takes an array leaves the original alone.
postproc::Field apart(postproc::Field field) {
    const auto copied = [](auto& data) {
        if (data != nullptr) {
            const auto original = data;
            data.TakeReference(original->NewInstance());
            data->ShallowCopy(original);
        }
    };
    for (auto& zone : field.zones) {
        copied(zone.surface);
        copied(zone.volume);
    }
    return field;
}
}  // namespace

postproc::Field Shell::read_field(const std::string& path, const postproc::ReadOptions& options) {
    if (caller_ != nullptr) {
        if (const auto known = caller_->fields.find(path); known != caller_->fields.end()) {
            return apart(known->second);
        }
    }
    return postproc::read_field(path, options, progress_);
}

void Shell::hand_over(const std::string& name, const std::function<core::Table()>& make) {
    if (caller_ != nullptr) {
        caller_->tables.emplace_back(name, make());
    }
}

void Shell::hand_over(const geometry::SurfaceMesh& surface) {
    if (caller_ != nullptr) {
        caller_->surface = surface;
    }
}

std::string Shell::program() const {
    if (caller_ == nullptr) {
        return std::filesystem::read_symlink("/proc/self/exe").string();
    }
    if (caller_->program.empty()) {
        throw core::UsageError("missing", "the program 'underbody', which the jobs call, is not installed here", {},
                               "install the Debian package underbody, or put the program's folder into PATH");
    }
    return caller_->program;
}

namespace {
std::string text_of(const core::Problem& problem) {
    const std::string where = problem.place.text();
    return where.empty() ? problem.message : where + ": " + problem.message;
}
}  // namespace

void Shell::will_write(const std::string& path) {
    if (!path.empty()) {
        core::refuse_other_file(path);
    }
}

namespace {

/// Whether both streams lead to one place (a terminal, a file, a pipe): who reads it reads a warning once.
bool read_by_one() {
    struct stat out {
    }, errors{};
    return (::isatty(STDOUT_FILENO) != 0 && ::isatty(STDERR_FILENO) != 0) ||
           (::fstat(STDOUT_FILENO, &out) == 0 && ::fstat(STDERR_FILENO, &errors) == 0 && out.st_dev == errors.st_dev &&
            out.st_ino == errors.st_ino);
}

}  // namespace

void Shell::release() {
    for (const std::string& text : std::exchange(held_back_, {})) {
        warn(text);
    }
}

void Shell::show(const core::Problems& problems, bool told) {
    for (const auto& problem : problems) {
        const std::string text = text_of(problem);
        if (problem.severity == core::Problem::Severity::note) {
            detail(text);
        } else if (said_.insert(text).second) {
            const bool in_text = !json && !list_on_stdout;
            if (in_text && !told) {
                print("warning: " + text);
            }
            if (caller_ != nullptr || !read_by_one()) {
                warn(text);
            } else if (!in_text || all_or_nothing) {
                held_back_.push_back(text);
            }
            undocumented_.push_back({text, problem.message});
        }
    }
}

void Shell::comment_warnings(core::Table& table) {
    for (const Warning& one : undocumented_) {
        if (std::none_of(table.comments.begin(), table.comments.end(),
                         [&](const std::string& comment) { return comment.find(one.message) != std::string::npos; })) {
            // Other files are none of the table's: who reads it has no use for them at each step.
            const bool of_others = one.message.starts_with(left_out_by_pattern);
            table.comments.push_back((of_others ? "" : "warning: ") + with_flags(one.text));
        }
    }
    if (list_on_stdout && !json) {
        documented();
    }
}

namespace {

constexpr const char* wrong_use = "wrong use";

/// The words for the parser. Behind "--from=" it would take the next word for the value.
std::vector<std::string> parted(int argc, const char* const* argv) {
    std::vector<std::string> words;
    for (int i = 1; i < argc; ++i) {
        const std::string_view word = argv[i];
        if (word.size() > 3 && word.starts_with("--") && word.find('=') == word.size() - 1) {
            words.emplace_back(word.substr(0, word.size() - 1));
            words.emplace_back();
        } else {
            words.emplace_back(word);
        }
    }
    std::reverse(words.begin(), words.end());  // as the parser takes them
    return words;
}

}  // namespace

void Shell::report(const core::Error& error, const char* what) {
    text_.clear();
    release();
    if (caller_ != nullptr) {
        caller_->error = with_flags(error.what());
        const bool usage =
            dynamic_cast<const core::UsageError*>(&error) != nullptr || std::string_view(what) == wrong_use;
        caller_->error_class = usage                                                       ? "UsageError"
                               : dynamic_cast<const core::InputError*>(&error) != nullptr  ? "InputError"
                               : dynamic_cast<const core::SystemError*>(&error) != nullptr ? "SystemError"
                               : dynamic_cast<const core::Cancelled*>(&error) != nullptr   ? "Cancelled"
                                                                                           : "Defect";
    } else {
        std::cerr << "underbody: " << what << ": " << with_flags(error.what()) << '\n';
    }
    if (!json) {
        return;
    }
    nlohmann::json detail = {
        {"kind", error.kind()}, {"message", with_flags(error.message())}, {"hint", with_flags(error.hint())}};
    const core::Place& place = error.place();
    if (!place.file.empty()) {
        detail["file"] = place.file;
    }
    if (place.line) {
        detail["line"] = *place.line;
    }
    if (place.column) {
        detail["column"] = *place.column;
    }
    if (place.byte) {
        detail["byte"] = *place.byte;
    }
    if (const auto* import = dynamic_cast<const postproc::ImportError*>(&error)) {
        detail["understood"] = import->understood();
    }
    print_json({{"error", detail}});
}

int Shell::run_action() {
    try {
        core::set_threads(threads);
        core::protect_other_files(!force);
        return action_ ? action_() : done;
    } catch (const core::Cancelled& error) {
        report(error, "stopped");
        return cancelled;
    } catch (const core::UsageError& error) {
        report(error, wrong_use);
        return wrong_usage;
    } catch (const core::InputError& error) {
        // A value with a unit that stands in no file stood on the command line.
        if (error.kind() == "exists") {
            report(core::InputError(error.kind(), error.message(), error.place(),
                                    error.hint() + ", or say --force to replace it"),
                   "error");
            return wrong_input;
        }
        const bool option = error.place().file.empty() && (error.kind() == "unit" || error.kind() == "parse");
        report(error, option ? wrong_use : "error");
        return option ? wrong_usage : wrong_input;
    } catch (const core::Error& error) {
        report(error, "error");
        return wrong_input;
    } catch (const std::filesystem::filesystem_error& error) {
        report(core::SystemError("file", error.code().message(), {error.path1().string(), {}, {}, {}}), "error");
        return wrong_input;
    } catch (const std::bad_alloc&) {
        report(core::SystemError("memory", "not enough memory"), "error");
        return wrong_input;
    } catch (const std::exception& error) {
        report(core::Error("defect", error.what(), {},
                           "this is a defect of underbody, not of your input: please report it with the command line"),
               "defect");
        return defect;
    }
}

int Shell::run(CLI::App& app, int argc, const char* const* argv) {
    watched = &progress_;
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    return execute(app, argc, argv);
}

int Shell::execute(CLI::App& app, int argc, const char* const* argv) {
    try {
        app.parse(parted(argc, argv));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
            return app.exit(error, std::cout, std::cerr);  // --help, --version
        }
        // The parser may have stopped before it set its flags.
        json =
            json || std::any_of(argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
        report(usage_error(app, error), wrong_use);
        return wrong_usage;
    }
    const int code = run_action();
    if (caller_ != nullptr) {
        return code;
    }
    if (all_or_nothing && code == done && !json) {
        std::cout << text_;
        documented();
    }
    std::cout.flush();
    release();
    if (!std::cout && code == done) {
        report(core::SystemError("write", "the output could not be written"), "error");
        return wrong_input;
    }
    return code;
}

}  // namespace underbody::studio
