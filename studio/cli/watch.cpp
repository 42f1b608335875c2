// underbody watch: reads a log as it grows and says when the vehicle stops being its model.
#include "surrogates/discovery/watch/watch.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/counted.h"
#include "core/no_limit.h"
#include "core/text.h"
#include "core/told.h"
#include "core/units.h"
#include "studio/cli/cause_search.h"
#include "studio/cli/commands.h"
#include "studio/cli/option_value.h"
#include "studio/cli/shell.h"
#include "surrogates/discovery/discovery.h"
#include "surrogates/discovery/wording.h"
#include "surrogates/dynamics/logs/growing.h"
#include "surrogates/dynamics/model/measurement_setup.h"
#include "surrogates/dynamics/plant/contact_gap.h"
#include "surrogates/dynamics/simulate/clean_readings.h"

namespace underbody::studio {

namespace {

struct WatchArguments {
    std::string model;
    std::string log = "-";
    std::string data;
    std::string learn = "60 s", after = "60 s";
    double per_day = 1;
    bool follow = false;
    bool no_cause = false;
};

/// The watch, what it says, and what happens after an alarm.
class Watching {
public:
    Watching(Shell& shell, const WatchArguments& arguments)
        : shell_(shell), arguments_(arguments), model_(dynamics::read_model(arguments.model)) {
        if (!arguments.data.empty()) {
            setup_ = dynamics::read_measurement_setup(arguments.data);
            if (setup_.motion == "surface" || setup_.motion == "body") {
                throw core::InputError(
                    "motion",
                    "a watch is of heave under input_force: these runs are of motion = \"" + setup_.motion +
                        "\", driven by jets, whose thrusts it does not know",
                    {arguments.data, {}, {}, {}},
                    "discover and predict follow them; leave motion out where no jet acts up or down");
            }
        }
        options_.false_alarms_per_day = arguments.per_day;
        options_.learn = option_value("--learn", arguments.learn, "s");
        after_ = option_value("--after", arguments.after, "s");
        options_.noise = setup_.noise;
        options_.conditions = setup_.conditions;
        watch_ = std::make_unique<discovery::Watch>(model_, options_);
    }

    [[nodiscard]] const dynamics::MeasurementSetup& setup() const { return setup_; }
    /// The log does not wait while what changed is looked for.
    void is_live() { live_ = true; }

    void reading(const std::string& quantity, double time, double value) {
        if (quantity == "input_force") {
            watch_->input(time, value);
        } else if (quantity == "heave_velocity") {
            watch_->velocity(time, value);
        } else if (quantity == "gap") {
            gap(time, value);
        } else {
            pitch_too_ = pitch_too_ || quantity == "pitch";
            watch_->condition(quantity, value);
        }
    }

    /// The log has ended, or somebody ended the watch. True if there was an alarm.
    bool end(bool cancelled, const core::Problems& problems) {
        look_again_ = core::no_limit;  // nothing more will be read
        if (!cancelled) {
            if (alarm_) {
                look_for_cause();
            }
            if (search_) {
                say_cause(search_->wait(shell_.progress()));
            }
        }
        search_.reset();
        const double watched = watch_->judged(), open = watch_->not_judged();
        const std::size_t passed_over = watch_->passed_over(), readings = watch_->readings();
        const bool nothing = watched == 0;
        const std::string alarms = std::to_string(alarms_) + (alarms_ == 1 ? " alarm" : " alarms");
        std::string text =
            seconds(last_) + ": " + (cancelled ? "ended by you" : "end of the log") + "; " +
            core::counted(readings, "reading") + ", " + seconds(watched) + " of them judged" +
            (open > 0.5 * watch_->block() ? ", the last " + core::format_number(open, 3) + " s not (judged every " +
                                                core::format_number(watch_->block(), 2) + " s)"
                                          : "") +
            "; " +
            (nothing && told_
                 ? "nothing was judged: no block of " + core::format_number(watch_->block(), 2) + " s was complete"
             : nothing                     ? "nothing was judged: the noise was still being learned"
             : alarms_ == 0 && fault_told_ ? "nothing changed since the noise was learned; what was wrong from the "
                                             "beginning is no change: discover"
             : alarms_ == 0 ? "nothing changed: the gap followed the model as it did while the noise was learned "
                              "(what was wrong from the beginning is no change: predict and discover)"
                            : alarms);
        const std::size_t outside = watch_->outside();
        text += outside > 0 ? "; " + core::counted(outside, "reading") + " outside the tables of the model" : "";
        text += pitch_too_ ? "; the pitch was taken as measured, whether it follows the model is not watched" : "";
        if (passed_over > 0) {
            text += "; " + core::counted(passed_over, "reading") + " whose time did not ascend " +
                    (passed_over == 1 ? "was" : "were") + " passed over";
        }
        nlohmann::json warnings = nlohmann::json::array();
        for (const core::Problem& problem : problems) {
            warnings.push_back(problem.place.text() + ": " + problem.message);
        }
        if (!problems.empty()) {
            text += "; " + std::to_string(problems.size()) + (problems.size() == 1 ? " warning" : " warnings") +
                    " about the log";
        }
        say({{"event", "end"},
             {"time", last_},
             {"readings", readings},
             {"judged", watched},
             {"not_judged", open},
             {"outside_tables", outside},
             {"passed_over", passed_over},
             {"alarms", alarms_},
             {"cancelled", cancelled},
             {"warnings", warnings}},
            text);
        if (shell_.caller() != nullptr) {
            shell_.print_json({{"events", events_}, {"alarms", alarms_}});
        }
        return alarms_ > 0;
    }

private:
    /// Seconds since 1970 to a hundredth as well: 1764337136.97 s.
    static std::string seconds(double time) {
        constexpr double large = 1e6;
        return core::format_number(std::abs(time) < large ? time : std::round(100 * time) / 100,
                                   std::abs(time) < large ? 8 : 12) +
               " s";
    }

    /// Own time goes on where the clock of the log is set: what was said of times before does not hold after it.
    void follow_clock(double time) {
        const double step = time - last_;
        own_time_ += begun_ ? std::clamp(step, 0.0, most_of_a_silence) : 0;
        if (begun_ && (step < -least_set_back || step > longest_pause)) {
            if (!search_) {
                story_.reset();
            }
            if (alarm_) {
                alarm_->since = time;
            }
        }
        begun_ = true;
        last_ = time;
    }

    void gap(double time, double value) {
        const auto alarm = watch_->gap(time, value);
        follow_clock(time);
        if (const auto& doubt = watch_->doubt()) {
            throw core::InputError("log", doubt->text, {arguments_.log, {}, {}, {}}, doubt->hint);
        }
        if (!outside_told_ && watch_->outside() >= enough_outside) {
            outside_told_ = true;
            say_outside();
        }
        if (!told_ && watch_->learned()) {
            told_ = true;
            block_ = watch_->block();
            say_learned();
        }
        if (told_ && watch_->block() != block_) {
            block_ = watch_->block();
            say({{"event", "learned_again"}, {"time", last_}, {"gap_noise", watch_->noise()}, {"block", block_}},
                seconds(last_) + ": the noise was learned again from more readings; now judged every " +
                    core::format_number(block_, 2) + " s");
        }
        if (!fault_told_ && watch_->fault()) {
            fault_told_ = true;
            say_fault(*watch_->fault());
        }
        if (search_ && search_->ready()) {
            say_cause(search_->wait(shell_.progress()));
        }
        if (alarm && alarm->sensor) {
            say_alarm(*alarm, alarm->shows + ", since " + seconds(alarm->since) + "; not judged until it moves again");
        } else if (alarm && !alarm_ && !search_ && !(own_time_ < silent_until_)) {
            alarm_ = alarm;
            search_at_ = own_time_ + after_;
            look_again_ = 2 * after_;
            say_alarm(*alarm, "the vehicle is no longer the model, since about " + seconds(alarm->since) +
                                  "; what shows is " + alarm->shows);
        }
        if (alarm_ && own_time_ >= search_at_) {
            look_for_cause();
        }
    }

    void say_alarm(const discovery::WatchAlarm& alarm, const std::string& text) {
        ++alarms_;
        say({{"event", "alarm"},
             {"time", alarm.time},
             {"since", alarm.since},
             {"shows", alarm.shows},
             {"sensor", alarm.sensor},
             {"force", alarm.force}},
            seconds(alarm.time) + ": " + text);
    }

    void say_outside() {
        const std::string range = dynamics::range_text(dynamics::lift_gap_range(model_));
        say({{"event", "outside_tables"}, {"time", last_}, {"tables", range}},
            seconds(last_) + ": the gap lies outside the tables of the model " + range +
                ", where nothing is known of the force: such readings are not judged");
    }

    void say_learned() {
        const double colour = watch_->correlation_time();
        const double rate = options_.false_alarms_per_day;
        // The rate was measured with what a minute teaches; of 10 s, 2 of 8 logs alarmed within four minutes.
        constexpr double enough = 60;  // s
        const bool stated = options_.learn >= enough;
        say({{"event", "learned"},
             {"time", last_},
             {"gap_noise", watch_->noise()},
             {"correlation_time", colour},
             {"block", watch_->block()},
             {"false_alarms_per_day", rate},
             {"rate_holds", stated}},
            seconds(last_) + ": watching, noise of the gap " + core::told(watch_->noise(), "m", 3) +
                (colour > 0 ? " (correlated over " + core::format_number(colour, 2) + " s)" : "") + ", judged every " +
                core::format_number(watch_->block(), 2) + " s; " +
                (stated ? "at most " + core::format_number(rate, 3) + (rate == 1 ? " false alarm" : " false alarms") +
                              " a day"
                        : "more false alarms than the " + core::format_number(rate, 3) + " a day asked for: " +
                              core::format_number(options_.learn, 3) + " s are too short to learn the noise (60 s)"));
    }

    /// Once, and no alarm: nothing changed.
    void say_fault(const discovery::WatchFault& fault) {
        std::string text = seconds(last_) + ": what noise was learned from is not the model with noise: ";
        if (fault.noisier) {
            text += "the gap has " + core::format_number(fault.noise / fault.declared, 2) +
                    " times the noise that is declared (" + core::told(fault.declared, "m", 3) + ")";
        }
        if (!fault.shows.empty()) {
            text += std::string(fault.noisier ? ", and " : "") + fault.shows +
                    (fault.force != 0 ? " (about " + core::told(std::abs(fault.force), "N", 2) + ")" : "") +
                    " would explain what passes for noise (" + core::told(fault.noise, "m", 3) + "; with it " +
                    core::told(fault.noise_with_it, "m", 3) + "): the model is wrong from the beginning";
        } else {
            text += ": the model is wrong from the beginning, or the sensor is noisier than declared";
        }
        say({{"event", "wrong_from_the_beginning"},
             {"time", last_},
             {"gap_noise", fault.noise},
             {"declared_noise", fault.declared > 0 ? nlohmann::json(fault.declared) : nlohmann::json()},
             {"noisier", fault.noisier},
             {"shows", fault.shows},
             {"force", fault.force}},
            text + "\n  `underbody discover` on this log says which; the watch goes on, with it as noise");
    }

    void look_for_cause() {
        alarmed_since_ = alarm_->since;
        looked_for_ = alarm_;
        alarm_.reset();
        const auto ask = [&](const dynamics::Model& of, double since) {
            CauseSearch::Question question{of, watch_->since(since)};
            question.model.records = {};  // what was read is as they say
            return question;
        };
        if (arguments_.no_cause) {
            go_on_as_before();
            return;
        }
        std::optional<CauseSearch::Question> earlier;
        if (story_) {
            earlier = ask(story_->model, story_->since);
        }
        if (live_) {
            say({{"event", "searching"}, {"time", last_}},
                seconds(last_) + ": looking for what changed; the log is read on");
            search_ = std::make_unique<CauseSearch>();
            search_->begin(ask(model_, alarmed_since_), std::move(earlier));
        } else {
            say_cause(CauseSearch::search(ask(model_, alarmed_since_), earlier, shell_.progress()));
        }
    }

    /// The watch goes on with the model as found.
    void say_cause(const CauseSearch::Result& result) {
        search_.reset();
        const discovery::Discovery& found = result.found;
        const double since = result.same_story ? story_->since : alarmed_since_;
        nlohmann::json event = {{"event", "cause"}, {"time", last_}, {"since", since}};
        if (!result.error.empty()) {
            begin_story();
            event["verdict"] = "unknown";
            event["sentence"] = result.error;
            say(event, seconds(last_) + ": what changed cannot be told: " + result.error);
            go_on_as_before();
            return;
        }
        event["verdict"] = found.verdict;
        event["sentence"] = found.sentence;
        event["effects"] = discovery::to_json(found)["effects"];
        const bool other = result.same_story || found.model.effects.size() != model_.effects.size();
        event["goes_on_with"] = other ? "model as found" : "model as before";
        std::string text = seconds(last_) + ": " +
                           (result.same_story ? "one change since " + seconds(since) + " explains all: " : "") +
                           found.sentence;
        for (const auto& effect : found.effects) {
            for (const auto& parameter : effect.parameters) {
                text += "\n  " + effect.name + ": " + discovery::number_name(effect, parameter) + " = " +
                        discovery::value_text(parameter);
            }
        }
        // what changed may be too little to be named yet: the same alarm, looked into with twice as much
        const bool look_again =
            !other && (found.structure || found.verdict == "unknown") && look_again_ <= 0.5 * options_.remember;
        event["looks_again_in"] = look_again ? nlohmann::json(look_again_) : nlohmann::json();
        text += std::string("\n  goes on with the model as ") + (other ? "found" : "before") +
                ", and with the noise as it was before the change" +
                (look_again ? "; looks again in " + core::format_number(look_again_, 4) + " s" : "");
        say(event, text);
        if (!other && look_again) {
            alarm_ = looked_for_;
            search_at_ = own_time_ + look_again_;
            look_again_ *= 2;
            return;
        }
        begin_story();
        if (!other) {
            go_on_as_before();
            return;
        }
        if (!result.same_story) {
            story_ = {model_, alarmed_since_};
        }
        const dynamics::RecordReading records = model_.records;
        model_ = found.model;
        model_.records = records;
        watch_->go_on_with(model_, std::clamp(last_ - since, after_, std::max(after_, own_time_)));
    }

    /// Of a change that may be one with what changes later.
    void begin_story() {
        if (!story_) {
            story_ = {model_, alarmed_since_};
        }
    }

    /// With the same model: the same change is not said again at once.
    void go_on_as_before() {
        watch_->reset();
        silent_until_ = own_time_ + after_;
    }

    /// A line at once; for a caller all of them at the end.
    void say(nlohmann::json event, const std::string& text) {
        if (shell_.caller() != nullptr) {
            events_.push_back(std::move(event));
        } else if (shell_.json) {
            std::cout << event.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
            if (event.contains("warnings")) {
                shell_.documented();
            }
        } else {
            shell_.print(text);
            std::cout.flush();
        }
    }

    Shell& shell_;
    const WatchArguments& arguments_;
    dynamics::Model model_;
    dynamics::MeasurementSetup setup_;
    discovery::WatchOptions options_;
    static constexpr double longest_pause = 30 * 86400.0, least_set_back = 0.5;  ///< s; beyond: the clock was set
    static constexpr double most_of_a_silence = 1;                               ///< s that count of one
    double after_ = 60, last_ = 0, alarmed_since_ = 0;
    bool begun_ = false;
    double own_time_ = 0, silent_until_ = -1e300, search_at_ = 0;  ///< s, of a clock that is never set
    double look_again_ = 0;                                        ///< s after this search, where nothing is named
    bool pitch_too_ = false;                                       ///< the log has it
    bool live_ = false;
    std::unique_ptr<discovery::Watch> watch_;
    /// The change that is being explained: the model before it, and since when.
    struct Story {
        dynamics::Model model;
        double since = 0;
    };
    std::optional<Story> story_;
    std::optional<discovery::WatchAlarm> alarm_, looked_for_;
    std::unique_ptr<CauseSearch> search_;
    nlohmann::json events_ = nlohmann::json::array();
    std::size_t alarms_ = 0;
    bool told_ = false, fault_told_ = false, outside_told_ = false;
    static constexpr std::size_t enough_outside = 20;  ///< readings
    double block_ = 0;                                 ///< s, as it was said last
};

/// Readings as they come go to the watch.
class WatchSink : public dynamics::ChannelSink {
public:
    WatchSink(const dynamics::LogChannels& channels, Watching& watching)
        : ChannelSink(channels, {}), watching_(watching) {}
    void reading(std::size_t channel, double time, double value) override {
        watching_.reading(channels().channels[channel].quantity, time, value);
    }

private:
    Watching& watching_;
};

void need_gap(const dynamics::LogChannels& channels, const std::string& name, const std::string& hint) {
    if (std::none_of(channels.channels.begin(), channels.channels.end(),
                     [](const dynamics::LogChannel& one) { return one.quantity == "gap"; })) {
        const bool ground = std::any_of(channels.channels.begin(), channels.channels.end(), [](const auto& one) {
            return one.quantity == "position_x" || one.quantity == "position_y";
        });
        throw core::InputError(
            "missing", "nothing says which number is the gap", {name, {}, {}, {}},
            ground ? "a run on the ground is not watched, only the gap of a body that glides: discover and "
                     "predict follow it"
                   : hint);
    }
}

void watch_csv(dynamics::GrowingStream& stream, const std::string& name, Watching& watching, core::Problems& problems) {
    const auto sink_of = [&](const core::Table& first) {
        dynamics::LogChannels channels = watching.setup().channels.of(false).with_csv_clock();
        if (channels.channels.empty()) {
            channels = dynamics::channels_by_name(first);
        }
        need_gap(channels, name, "a column gap [m] beside time [s], or [log.channel.gap] in a dataset.toml");
        return std::make_unique<WatchSink>(channels, watching);
    };
    dynamics::read_csv_stream(stream, name, sink_of, problems);
}

void watch_log(const WatchArguments& arguments, Watching& watching, Shell& shell, core::Problems& problems) {
    const auto by_mapping = [&](const auto& read) {
        const dynamics::LogChannels channels = watching.setup().channels.of(true);
        need_gap(channels, arguments.log,
                 "a dataset.toml with [log.channel.gap] message = ..., field = ..., named with --data");
        WatchSink sink(channels, watching);
        const dynamics::LogEnd end = read(sink);
        sink.check_all_found(arguments.log, end);
        problems = end.problems;
    };
    if (!arguments.follow && arguments.log != "-" &&
        !dynamics::log_format(std::filesystem::path(arguments.log)).empty()) {
        by_mapping([&](WatchSink& sink) {
            return dynamics::read_log(std::filesystem::path(arguments.log), sink, shell.progress());
        });
        return;
    }
    dynamics::GrowingStream stream(arguments.log, arguments.follow, shell.progress());
    if (stream.live()) {
        watching.is_live();
    }
    const std::string first = stream.first(16);
    if (first.empty()) {
        throw core::InputError("missing", "the log is empty", {arguments.log, {}, {}, {}},
                               "to wait for what will be written to it: --follow");
    }
    if (dynamics::log_format(std::string_view(first)).empty()) {
        watch_csv(stream, arguments.log, watching, problems);
    } else {
        by_mapping([&](WatchSink& sink) { return dynamics::read_log(stream, arguments.log, sink, shell.progress()); });
    }
}

int run_watch(const WatchArguments& arguments, Shell& shell) {
    Watching watching(shell, arguments);
    core::Problems problems;
    try {
        watch_log(arguments, watching, shell, problems);
        shell.show(problems);
        return watching.end(false, problems) ? ExitCode::check_failed : ExitCode::done;
    } catch (const core::Cancelled&) {
        shell.show(problems);
        watching.end(true, problems);
        return ExitCode::cancelled;
    }
}

}  // namespace

void add_watch_command(CLI::App& app, Shell& shell) {
    CLI::App* command =
        app.add_subcommand("watch", "read a log as it grows and say when the vehicle stops being its model");
    auto a = std::make_shared<WatchArguments>();
    command->add_option("model", a->model, "the model (model.toml)")->required();
    command->add_option("log", a->log, "CSV file, PX4 ULog, DataFlash or ROS 2 bag; - (default): from a pipe");
    command->add_option("--data", a->data,
                        "dataset.toml that says which message is which channel ([log]), noise and conditions");
    command->add_option("--per-day", a->per_day, "false alarms a day at most (default 1)")->check(CLI::PositiveNumber);
    command->add_option("--learn", a->learn, "time in which noise and its colour are learned (default 60 s)");
    command->add_option("--after", a->after, "time after an alarm until what changed is looked for (default 60 s)");
    command->add_flag("--follow", a->follow, "go on waiting at the end of the file; Ctrl-C ends it");
    command->add_flag("--alarms-only", a->no_cause, "do not look for what changed");
    command->footer(
        "Examples:\n"
        "  underbody watch model.toml run.csv\n"
        "  underbody watch model.toml flight.ulg --data dataset.toml --follow --json\n"
        "  nc rig 5000 | underbody watch model.toml --per-day 0.1\n"
        "With --json each thing said is one JSON object on a line of its own, at once.\n"
        "Exit code 4: there was an alarm. After one it looks for what changed and goes on with the model as found.");
    shell.on(command, [a, &shell] { return run_watch(*a, shell); });
}

}  // namespace underbody::studio
