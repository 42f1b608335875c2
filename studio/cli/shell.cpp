#include "studio/cli/shell.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/own_files.h"
#include "core/parallel.h"
#include "postproc/field/import_error.h"
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

void Shell::on(CLI::App* command, std::function<int()> action) {
    command->callback([this, action = std::move(action)] { action_ = action; });
}

void Shell::print_json(const nlohmann::json& document) {
    // NaN has no place in JSON: nlohmann writes null for it. Names of files may be of any bytes.
    std::cout << document.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

void Shell::print(const std::string& text) {
    if (!json) {
        std::cout << with_flags(text) << (text.ends_with('\n') ? "" : "\n");
    }
}

void Shell::warn(const std::string& text) { std::cerr << "underbody: warning: " << with_flags(text) << '\n'; }

void Shell::info(const std::string& text) {
    if (!quiet) {
        std::cerr << "underbody: " << with_flags(text) << '\n';
    }
}

void Shell::detail(const std::string& text) {
    if (verbose) {
        std::cerr << "underbody: " << with_flags(text) << '\n';
    }
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

void Shell::remark(const core::Problems& problems) {
    if (json) {
        show(problems);
        return;
    }
    for (const auto& problem : problems) {
        problem.severity == core::Problem::Severity::note ? detail(text_of(problem))
                                                          : print("warning: " + text_of(problem));
    }
}

void Shell::show(const core::Problems& problems) {
    for (const auto& problem : problems) {
        const std::string text = text_of(problem);
        if (problem.severity == core::Problem::Severity::note) {
            detail(text);
        } else {
            warn(text);
        }
    }
}

void Shell::report(const core::Error& error, const char* what) {
    std::cerr << "underbody: " << what << ": " << with_flags(error.what()) << '\n';
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
        report(error, "wrong use");
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
        report(error, option ? "wrong use" : "error");
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
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) {
            return app.exit(error, std::cout, std::cerr);  // --help, --version
        }
        // The parser may have stopped before it set its flags.
        json =
            json || std::any_of(argv, argv + argc, [](const char* word) { return std::string_view(word) == "--json"; });
        report(usage_error(app, error), "wrong use");
        return wrong_usage;
    }
    const int code = run_action();
    std::cout.flush();
    if (!std::cout && code == done) {
        report(core::SystemError("write", "the output could not be written"), "error");
        return wrong_input;
    }
    return code;
}

}  // namespace underbody::studio
