// State, actions, history, session files, log and replay of the desktop, without a window.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <random>

#include "cases/accept.h"
#include "core/file.h"
#include "studio/desktop/state/action_log.h"
#include "studio/desktop/state/known_models.h"
#include "studio/desktop/state/session_file.h"
#include "tests/support/support.h"

namespace underbody::studio {
namespace {

namespace fs = std::filesystem;

/// The shipped study without what a run of it left beside its files.
fs::path evie() {
    static const core::TemporaryFolder folder;
    static const fs::path copy = [] {
        const fs::path shipped = test::source_folder() / "cases" / "evie", own = folder.path() / "evie";
        fs::create_directory(own);
        for (const fs::directory_entry& entry : fs::directory_iterator(shipped)) {
            if (entry.path().filename() != ".underbody") {
                fs::copy(entry.path(), own / entry.path().filename(), fs::copy_options::recursive);
            }
        }
        return own;
    }();
    return copy;
}

SessionPointer evie_session() {
    static const SessionPointer session = open_session(evie());
    return session;
}

/// A folder with what is named in actions and stands outside the shipped study.
fs::path elsewhere() {
    static const core::TemporaryFolder folder;
    static const bool made = [] {
        fs::create_directories(folder.path() / "evie");
        fs::copy(evie() / "study.toml", folder.path() / "evie" / "study.toml");
        fs::create_directories(folder.path() / "moved");
        for (const char* name : {"a.csv", "b.csv", "moved/a.csv"}) {
            fs::copy(evie() / "fields" / "ellipse-h5-p0.csv", folder.path() / name);
        }
        return true;
    }();
    EXPECT_TRUE(made);
    return folder.path();
}

/// What was last seen of the shipped study.
fs::path kept_evie() {
    static const core::TemporaryFolder folder;
    State state;
    state.study = evie().string();
    state.workspace = "loop";
    state.explore.brush["gap"] = {0.002, 0.005};
    write_session(state, folder.path() / "kept.ubs");
    return folder.path() / "kept.ubs";
}

/// A line of every verb and every key, fit for the shipped study.
std::vector<std::string> every_action() {
    return {
        "workspace tables",
        "select case/ellipse-h5-p0 case/ellipse-h2-p0 table/drag region/glide",
        "star case/ellipse-h5-p0",
        "unstar case/ellipse-h5-p0",
        "shape rectangle",
        "set 'body.base_cut=0.7'",
        "pin",
        "set 'protrusion.height=1.5 mm' 'protrusion.length=8 mm'",
        "reset protrusion.length",
        "keep rectangle-2",
        "set body.base_cut=0.72",
        "reset",
        "forget rectangle-2",
        "operation gap=3mm pitch=1deg speed=0.7m/s",
        "fields array=wall_shear whole_range=on edges=on mirror=off difference=on range=-100:100 camera=bottom "
        "zone.hull=off",
        "table lift net_weight=0.28N virtual_mass=4kg logarithmic=on 'shown=curve gap'",
        "table 'lift over gap and pitch' held.pitch=1deg",
        "table 'lift over gap and pitch' 'beside=map gap pitch,curve pitch'",
        "region glide beside=probability,estimator",
        "region glide feedback=gap_gain=10,velocity_gain=9,reference=20mm,limit=0.05N",
        "region glide start=gap=5mm,pitch=2deg",
        "cells design body section",
        "turn design 0.3,0.2,-0.1/0,0,0/0,0,1/50mm",
        "turn compare 0,0,-0.4/0,0,0/0,1,0/0.1",
        "outline off",
        "region glide cells=60 duration=20s set.vehicle.net_weight=0.2 start=5mm,10mm/s",
        "region glide as_declared=",
        "axes pitch drag_force",
        "brush gap=2mm:5mm lift_force=0:0.4",
        "vary protrusion.height=1mm:3mm:3 body.base=ellipse,rectangle",
        "brush volume=2000cm^3:2300cm^3",
        "rows cases",
        "order lift_force gap",
        "show pictures",
        "exported /tmp/lift.h lift made_of=abc format=c name=lift frame=ned number=float max_error=0.01 "
        "range.gap=clamp",
        "exported /tmp/lift.h lift made_of=abc written=def format=c name=lift and /tmp/drag.h drag format=c name=drag",
        "measure tank model=" + (evie() / "heave" / "model.toml").string() + " data=" + (evie() / "heave").string() +
            " channel=gap=rng_cm:cm clock=t_ms:ms",
        "add field " + (elsewhere() / "a.csv").string(),
        "read " + (elsewhere() / "a.csv").string() + " length_unit=mm unit.Pressure=kPa symmetry=y zones=hull*,base",
        "fields view=speed-symmetry time=0.5s probe=10mm,0,2mm",
        "read " + (elsewhere() / "a.csv").string() + " symmetry=y=0.1 density=998kg/m^3",
        "region glide show=estimator gap_noise=0.1mm velocity_noise=1mm/s drag_error=0.3",
        "add shape " + (evie() / "shapes" / "ellipse_front_bump1.toml").string(),
        "remove " + (evie() / "shapes" / "ellipse_front_bump1.toml").string(),
        "locate " + evie().string() + " " + (elsewhere() / "evie").string(),
        "session " + kept_evie().string(),
        "open " + evie().string()};
}

State opened() {
    State state;
    return applied(state, {"open", evie().string()}, *evie_session());
}

TEST(StudioWords, ReadBackWhatTheyWrote) {
    std::mt19937 random(3);
    const std::string letters = "ab='\" \\#$;x\t*";
    for (int round = 0; round < 2000; ++round) {
        Words words(1 + random() % 4);
        for (auto& word : words) {
            const auto size = random() % 6;
            for (std::size_t i = 0; i < size; ++i) {
                word += letters[random() % letters.size()];
            }
        }
        EXPECT_EQ(words_of(line_of(words)), words) << line_of(words);
    }
    EXPECT_EQ(words_of("set a=1 # a comment"), (Words{"set", "a=1"}));
    EXPECT_THROW(words_of("set 'a=1"), core::InputError);
}

// The quoting is that of a shell, not only our own.
TEST(StudioWords, AShellReadsTheSameWords) {
    const Words words = {"printf", "%s|", "a b", "it's", "$HOME", "", "x=\"1\"", "*"};
    FILE* pipe = ::popen(line_of(words).c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    char text[200] = {};
    const auto count = std::fread(text, 1, sizeof text - 1, pipe);
    ::pclose(pipe);
    EXPECT_EQ(std::string(text, count), "a b|it's|$HOME||x=\"1\"|*|");
}

TEST(StudioActions, EachIsDoneUndoneAndRedone) {
    std::set<std::string> verbs;
    History history(opened());
    for (const auto& line : every_action()) {
        const std::string before = state_hash(*history.state());
        const auto words = words_of(line);
        verbs.insert(words.front());
        ASSERT_NO_THROW(history.act(words, *evie_session())) << line;
        const std::string after = state_hash(*history.state());
        EXPECT_NE(before, after) << line;
        ASSERT_TRUE(history.undo()) << line;
        EXPECT_EQ(state_hash(*history.state()), before) << line;
        ASSERT_TRUE(history.redo()) << line;
        EXPECT_EQ(state_hash(*history.state()), after) << line;
        EXPECT_FALSE(history.steps().back().name.empty()) << line;
    }
    verbs.insert({"accept", "unaccept"});  // AcceptedModels: they need a discovery
    for (const auto& kind : action_kinds()) {
        EXPECT_TRUE(verbs.contains(kind.verb)) << "no test of '" << kind.verb << "'";
    }
    const auto most = history.position();
    const std::string last = state_hash(*history.state());
    history.go_to(0);
    EXPECT_EQ(*history.state(), opened());
    history.go_to(most);
    EXPECT_EQ(state_hash(*history.state()), last);
}

// A look at another workspace lost what could be redone.
TEST(StudioHistory, LookingAboutKeepsWhatCanBeRedone) {
    History history(opened());
    std::vector<std::string> lines;
    history.on_line = [&](const std::string& line) { lines.push_back(line); };
    const auto act = [&](const char* line, const char* gesture = "") {
        return history.act(words_of(line), *evie_session(), gesture);
    };
    act("operation gap=7mm");
    act("operation gap=6mm");
    const std::string last = state_hash(*history.state());
    history.undo();
    ASSERT_TRUE(act("workspace tables"));
    ASSERT_TRUE(act("turn design 0.3,0.2,-0.1/0,0,0/0,0,1/0.05", "drag"));
    ASSERT_TRUE(act("turn design 0.3,0.3,-0.1/0,0,0/0,0,1/0.05", "drag"));
    EXPECT_EQ(history.state()->workspace, "tables");
    EXPECT_EQ(history.steps().size(), 2U);
    ASSERT_TRUE(history.redo());
    EXPECT_EQ(state_hash(*history.state()), last);
    EXPECT_EQ(lines, (std::vector<std::string>{"operation gap=7mm", "operation gap=6mm", "undo", "workspace tables",
                                               "turn design 0.3,0.3,-0.1/0,0,0/0,0,1/0.05", "redo"}));
    history.undo();
    act("operation gap=8mm");
    EXPECT_EQ(history.steps().size(), 2U) << "what changes something drops it";
    EXPECT_FALSE(history.redo());
}

// A view that a hand turned was lost with the window.
TEST(StudioState, AViewThatWasTurnedIsKept) {
    State state = opened();
    for (const char* line : {"turn design 0.3,0.2,-0.1/0,0,0/0,0,1/50mm", "turn compare 0,0,-400mm/0,0,0/0,1,0/0.1"}) {
        state = applied(state, words_of(line), *evie_session());
    }
    ASSERT_TRUE(state.design.turned && state.fields.turned);
    EXPECT_EQ(text_of(*state.design.turned), "0.3,0.2,-0.1/0,0,0/0,0,1/0.05");
    EXPECT_EQ(text_of(*state.fields.turned), "0,0,-0.4/0,0,0/0,1,0/0.1");
    EXPECT_EQ(state_from_json(nlohmann::json(state)), state) << "in the session";
    const State other = applied(state, words_of("select case/ellipse-h2-p0"), *evie_session());
    EXPECT_EQ(other.fields.turned, state.fields.turned) << "cases are seen alike";
    EXPECT_FALSE(applied(state, words_of("fields camera=iso"), *evie_session()).fields.turned);
    EXPECT_FALSE(applied(state, words_of("turn design"), *evie_session()).design.turned);
    for (const char* nonsense :
         {"turn tables 0.3,0.2,-0.1/0,0,0/0,0,1/1", "turn design 1,2,3", "turn design 0,0,0/0,0,0/0,0,1/1",
          "turn design 0,0,1/0,0,0/0,0,1/1", "turn design 0.3,0.2,-0.1/0,0,0/0,0,1/0"}) {
        EXPECT_THROW(applied(state, words_of(nonsense), *evie_session()), core::UsageError) << nonsense;
    }
}

// Files from outside may be of any size: one that is turned by hand says nothing of another.
TEST(StudioState, AnotherFileFromOutsideIsSeenWhole) {
    State state = opened();
    const std::string a = (elsewhere() / "a.csv").string(), b = (elsewhere() / "b.csv").string();
    core::write_file(b, core::read_file(a));
    for (const std::string& line :
         {"add field " + a, "add field " + b, "select field/" + a, std::string("turn compare 0,0,-0.4/0,0,0/0,1,0/0.1"),
          "select field/" + a + " field/" + b}) {
        state = applied(state, words_of(line), *evie_session());
    }
    EXPECT_TRUE(state.fields.turned) << "one more beside it";
    EXPECT_TRUE(applied(state, words_of("select field/" + b), *evie_session()).fields.turned);
    state = applied(state, words_of("select field/" + a), *evie_session());
    const State shape = applied(state, words_of("select shape/ellipse"), *evie_session());
    EXPECT_TRUE(applied(shape, words_of("select field/" + a), *evie_session()).fields.turned) << "back from a shape";
    EXPECT_FALSE(applied(shape, words_of("select field/" + b), *evie_session()).fields.turned);
    EXPECT_FALSE(applied(state, words_of("select field/" + b), *evie_session()).fields.turned);
    EXPECT_FALSE(applied(state, words_of("select case/ellipse-h2-p0"), *evie_session()).fields.turned);
}

// F12 proposed no name.
TEST(StudioState, AFileIsNamedAfterWhatIsSeen) {
    State state = opened();
    EXPECT_EQ(proposed_name(state, *evie_session()), "design-ellipse");
    state = applied(state, words_of("workspace tables"), *evie_session());
    EXPECT_EQ(proposed_name(state, *evie_session()).substr(0, 7), "tables-");
    state = applied(state, words_of("select 'table/lift over gap and pitch'"), *evie_session());
    EXPECT_EQ(proposed_name(state, *evie_session()), "tables-lift_over_gap_and_pitch");
    state = applied(state, words_of("workspace compare"), *evie_session());
    EXPECT_EQ(proposed_name(state, *evie_session()), "compare-pressure");
    state = applied(state, words_of("select case/ellipse-h5-p0 case/ellipse-h2-p0"), *evie_session());
    EXPECT_EQ(proposed_name(state, *evie_session()), "compare-pressure-ellipse-h5-p0-and-1");
}

// What somebody said of a file goes with it: into the command, away with it, and to where it has moved.
TEST(StudioActions, WhatAFileDoesNotSayGoesWithIt) {
    History history(opened());
    const auto act = [&](const std::string& line) { history.act(words_of(line), *evie_session()); };
    const std::string a = (elsewhere() / "a.csv").string(), b = (elsewhere() / "b.csv").string();
    const std::string moved = (elsewhere() / "moved" / "a.csv").string();
    act("add field " + a);
    act("add field " + b);
    act("read " + a + " " + b + " length_unit=mm unit.Pressure=kPa symmetry=y zones=hull*,base");
    EXPECT_EQ(history.steps().back().command,
              "underbody loads " + a + " --length-unit mm --unit Pressure=kPa --symmetry y --zones 'hull*,base'");
    EXPECT_EQ(history.state()->readings.size(), 2U);
    EXPECT_THROW(act("read " + a + " length_unit=Pa"), core::Error);
    EXPECT_THROW(act("read " + a + " lenght_unit=mm"), core::Error);
    act("read " + a + " symmetry=none");
    EXPECT_EQ(history.state()->readings.at(a).symmetry, "none") << "whole, whatever the study says";
    act("read " + a + " symmetry=y");
    act("locate " + a + " " + moved);
    EXPECT_EQ(history.state()->readings.at(moved).length_unit, "mm");
    act("remove " + b);
    EXPECT_FALSE(history.state()->readings.contains(b));
    act("read " + moved + " length_unit= unit.Pressure= symmetry= zones=");
    EXPECT_TRUE(history.state()->readings.empty()) << "nothing said is nothing kept";
    history.go_to(3);
    const core::TemporaryFolder folder;
    write_session(*history.state(), folder.path() / "s.ubs");
    EXPECT_EQ(read_session(folder.path() / "s.ubs").state.readings, history.state()->readings);
}

TEST(StudioActions, WrongOnesSayWhatIsRightAndChangeNothing) {
    History history(opened());
    const std::vector<std::pair<std::string, std::string>> wrong = {
        {"worspace tables", "workspace"},
        {"workspace tabels", "tables"},
        {"set protrusion.heigth=2mm", "height"},
        {"set body.base_cut=7", "base_cut"},
        {"table lft net_weight=1N", "lift"},
        {"table lift net_wait=1N", "net_weight"},
        {"region glid cells=30", "glide"},
        {"region glide cells=3", "20"},
        {"fields camera=botom", "bottom"},
        {"fields view=speed-symetry", "speed-symmetry"},
        {"read /data/other.csv length_unit=mm", "add field"},
        {"read length_unit=mm", "no file"},
        {"region glide gap_noise=0", "noise of the gap"},
        {"operation gap=-3mm", "gap"},
        {"brush gap=5mm:2mm", "smaller"},
        {"keep ellipse", "another name"},
        {"forget nothing", "nothing"},
        {"shape elipse", "ellipse"},
        {"vary body.base_cut", "PARAMETER=VALUES"},
        {"vary body.bas_cut=0.6:0.8:3", "base_cut"},
        {"vary body.base_cut=0.6:0.8:9999", "5000"},
        {"vary body.base_cut=0.6,0.7 body.base_cut=0.8,0.9", "twice"},
        {"rows shape", "shapes"},
        {"exported lift.h lift fromat=c", "format"},
        {"accept 'heave tst'", "heave test"},
        {"accept 'heave test'", "discover"},  // not yet, or in a report that is elsewhere
        {"unaccept x", "accepted"},
        {"select nonsense", "KIND/NAME"},
        {"select file/one", "field"},
        {"select case/elipse-h5-p0", "ellipse-h5-p0"},
        {"select case/ellipse-h5-p0 table/lft", "lift"},
        {"select field/one.csv", "nor any other"},
        {"star case/ellipse-h5-p9", "ellipse-h5-p0"},
        {"star cases/ellipse-h5-p0", "case"},
        {"unstar case/ellipse-h5-p0", "no star"},
        {"add field /no/such/file.csv", "no file or folder"},
        {"add fields a.csv", "field"},
        {"add shape " + (elsewhere() / "a.csv").string(), "a.csv"},
        {"add field " + (elsewhere() / "a.cvs").string(), "did you mean 'a.csv'"},
        {"remove " + (elsewhere() / "a.csv").string(), "outside the study"},
        {"locate /no/such/evie " + (elsewhere() / "evie").string(), "study or file"},
        {"locate " + evie().string() + " " + (elsewhere() / "eve").string(), "did you mean 'evie'"},
        {"open " + (elsewhere() / "moved").string(), "no study.toml"},
        {"open " + (elsewhere() / "eve").string(), "did you mean 'evie'"},
        {"reset protrusion.heigth", "protrusion.height"},
        {"table lift shown=curve pitch", "curve AXIS"},
        {"table lift 'shown=curve pitch'", "gap"},
        {"table lift shown=curv", "curve"},
        {"table lift 'shown=map gap gap'", "no view"},
        {"table lift held.gapp=1mm", "gap"},
        {"table lift 'beside=map gap gap'", "no view"},
        {"region glide beside=ends,estmator", "estimator"},
        {"region glide feedback=gap_gian=10", "gap_gain"},
        {"region glide start=gap=5mm,speed=1m/s", "state of a start"},
        {"cells desing body", "design"},
        {"cells design bodi", "body"},
        {"region glide set.vehicle.net_wait=0.2", "vehicle.net_weight"},
        {"region glide set.vehicle.mass=-1", "mass"},
        {"region glide set.force.99.factor=2", "force.99.factor"},
        {"region glide axes=gap=1mm:20mm,speed=0:1", "axis of a map"},
        {"region glide sweep=sped=0:1", "speed"},
        {"axes gap lift_forc", "lift_force"},
        {"brush lift_forc=0:1", "lift_force"},
        {"brush lift_forc=", "lift_force"},
        {"order lift_forc", "lift_force"},
        {"order gap gap", "twice"},
        {"exported /tmp/lift.h lift and /tmp/drag.h drg", "drag"},
        {"exported /tmp/lift.h lift and", "exported FILE TABLE"},
        {"exported /tmp/lift.h lft", "lift"},
        {"exported /tmp/lift.h lift format=cc", "no format"},
        {"exported /tmp/lift.h lift frame=nde", "ned"},
        {"exported /tmp/lift.h lift number=flot", "float"},
        {"exported /tmp/lift.h lift range.gap=clam", "clamp"},
        {"exported /tmp/lift.h lift range.gup=clamp", "gap"},
        {"", "action"}};
    const StatePointer before = history.state();
    for (const auto& [line, told] : wrong) {
        try {
            history.act(words_of(line), *evie_session());
            ADD_FAILURE() << line;
        } catch (const core::Error& error) {
            EXPECT_NE(std::string(error.what()).find(told), std::string::npos) << line << ": " << error.what();
        }
        EXPECT_EQ(history.state(), before) << line;
        EXPECT_EQ(history.position(), 0U) << line;
    }
}

// A slider over a number of the model does not read the file at each of its steps; a file that has changed is read.
TEST(StudioActions, AModelIsReadOnceUntilItChanges) {
    const core::TemporaryFolder folder;
    for (const char* name : {"glide.toml", "forces.csv", "model.toml"}) {
        fs::copy(evie() / name, folder.path() / name);
    }
    const fs::path file = folder.path() / "glide.toml";
    const auto first = known_model(file);
    const auto read = models_read();
    EXPECT_EQ(known_model(file), first);
    EXPECT_EQ(models_read(), read);
    core::write_file(file, core::read_file(file) + "\n# changed\n");
    EXPECT_NE(known_model(file), first);
    EXPECT_EQ(models_read(), read + 1);
    State state = opened();
    state = applied(state, words_of("region glide set.vehicle.net_weight=0.2"), *evie_session());
    const auto before = models_read();
    for (int i = 0; i < 20; ++i) {
        state =
            applied(state, words_of("region glide set.vehicle.net_weight=0.2" + std::to_string(i)), *evie_session());
    }
    EXPECT_EQ(models_read(), before);
}

TEST(StudioActions, ADragIsOneStepAndOneLine) {
    History history(opened());
    std::vector<std::string> lines;
    history.on_line = [&](const std::string& line) { lines.push_back(line); };
    for (int i = 1; i <= 50; ++i) {
        history.act({"set", "protrusion.height=" + std::to_string(50 + i) + "e-2 mm"}, *evie_session(), "drag 1");
    }
    history.end_gesture();
    EXPECT_EQ(history.position(), 1U);
    EXPECT_EQ(lines, (std::vector<std::string>{"set 'protrusion.height=100e-2 mm'"}));
    history.act({"set", "protrusion.height=1 mm"}, *evie_session(), "drag 2");
    history.end_gesture();
    EXPECT_EQ(history.position(), 2U);
    history.undo();
    EXPECT_EQ(history.state()->design.changes.at("ellipse").at("protrusion.height"), "100e-2 mm");
    history.act({"set", "protrusion.height=2 mm"}, *evie_session(), "drag 3");
    history.act({"set", "protrusion.height=100e-2 mm"}, *evie_session(), "drag 3");  // and back
    history.end_gesture();
    EXPECT_EQ(history.position(), 1U);
}

TEST(StudioActions, ShapesAreTheLibrarys) {
    State state = opened();
    state = applied(state, words_of("set 'protrusion.height=2 mm' body.base_cut=0.7"), *evie_session());
    const auto shape = shape_of(state, *evie_session(), "ellipse");
    EXPECT_DOUBLE_EQ(shape.protrusion->height, 0.002);
    EXPECT_DOUBLE_EQ(shape.base_cut, 0.7);
    state = applied(state, words_of("keep bumped"), *evie_session());
    EXPECT_EQ(shape_hash(shape_of(state, *evie_session(), "bumped")), shape_hash(shape));
    EXPECT_EQ(shape_hash(shape_of(state, *evie_session(), "ellipse")),
              shape_hash(evie_session()->shapes.at("ellipse")));
    const std::string command = command_of(state, words_of("keep bumped"), *evie_session());
    EXPECT_NE(command.find("--set body.base_cut=0.7 --set 'protrusion.height=2 mm' --as bumped.toml"),
              std::string::npos)
        << command;
}

// What Explore varies and keeps stands in the session, and the line of it makes the same shapes.
TEST(StudioActions, WhatIsVariedIsSavedAndHasACommand) {
    State state = opened();
    state = applied(state, words_of("set body.base_cut=0.7"), *evie_session());
    state = applied(state, words_of("vary protrusion.height=1mm:3mm:3"), *evie_session());
    state = applied(state, words_of("brush volume=2000cm^3:2300cm^3"), *evie_session());
    ASSERT_EQ(state.explore.vary.size(), 1U);
    EXPECT_EQ(state.explore.vary[0].values, (std::vector<std::string>{"1 mm", "2 mm", "3 mm"}));
    EXPECT_TRUE(state.explore.shapes);
    EXPECT_DOUBLE_EQ(state.explore.brush.at("volume")[0], 2000e-6);
    EXPECT_EQ(state_from_json(nlohmann::json(state)), state);
    const std::string command = command_of(state, words_of("brush volume=2000cm^3:2300cm^3"), *evie_session());
    EXPECT_NE(command.find("underbody body sweep "), std::string::npos) << command;
    EXPECT_NE(command.find("--set body.base_cut=0.7 --vary 'protrusion.height=1 mm,2 mm,3 mm' --where volume=0.002"),
              std::string::npos)
        << command;
    state = applied(state, words_of("rows cases"), *evie_session());
    EXPECT_TRUE(command_of(state, words_of("brush gap=2mm:5mm"), *evie_session()).empty());
    state = applied(state, words_of("vary"), *evie_session());
    EXPECT_TRUE(state.explore.vary.empty());
}

/// The shipped study as if an effect had been found in its measurement.
struct Discovered {
    explicit Discovered(const fs::path& folder) {
        fs::copy(evie() / "study.toml", folder / "study.toml");
        for (const char* part : {"heave", "fields", "shapes", "tables"}) {
            fs::create_directory_symlink(evie() / part, folder / part);
        }
        for (const char* part : {"glide.toml", "model.toml", "forces.csv"}) {
            fs::copy(evie() / part, folder / part);
        }
        const fs::path report = folder / "report" / "discovery" / "heave test";
        const std::string said = R"({"verdict": "effect", "sentence": "The model lacks coulomb_friction."})";
        core::write_file(report / "discovery.json", said);
        core::write_file(report / "model.toml", core::read_file(evie() / "heave" / "model.toml") +
                                                    "\n[[effect]]\nname = \"coulomb_friction\"\nforce = \"0.01 N\"\n");
        core::write_file(report / "jet_lift.csv", core::read_file(evie() / "heave" / "jet_lift.csv"));
        core::write_file(report / "next-experiment.csv", "time [s]\n0\n");
        auto made = std::make_shared<Session>(*open_session(folder));
        made->results.documents.emplace_back("discovery/heave test", said);
        session = made;
        state.study = session->folder.string();
    }
    SessionPointer session;
    State state;
};

TEST(AcceptedModels, CountAsTheDeclaredOnesAndAreTakenBack) {
    const core::TemporaryFolder folder;
    const Discovered found(folder.path());
    const fs::path declared = found.session->study.measurements.front().model;
    const State accepted = applied(found.state, words_of("accept 'heave test'"), *found.session);
    const SessionPointer with = with_models(found.session, accepted.accepted);
    EXPECT_EQ(with->study.measurements.front().model.filename(), "model.toml");
    EXPECT_NE(with->study.measurements.front().model, declared);
    EXPECT_EQ(with->study.regions.front().model, found.session->study.regions.front().model) << "of another model";
    EXPECT_EQ(with_models(with, {})->study.measurements.front().model, declared);
    EXPECT_EQ(applied(accepted, words_of("unaccept 'heave test'"), *with), found.state);
    EXPECT_EQ(state_from_json(nlohmann::json(accepted)), accepted);
    EXPECT_NE(command_of(accepted, words_of("accept 'heave test'"), *with).find("underbody study accept"),
              std::string::npos);
}

// The report may lie elsewhere: the store has the model that was found.
TEST(AcceptedModels, NeedNoReportBesideTheStudy) {
    const core::TemporaryFolder folder;
    const Discovered found(folder.path());
    const fs::path report = folder.path() / "report" / "discovery" / "heave test";
    const std::string model = core::read_file(report / "model.toml");
    const nlohmann::json files = {{"model.toml", model}, {"jet_lift.csv", core::read_file(report / "jet_lift.csv")}};
    fs::remove_all(folder.path() / "report");
    EXPECT_THROW(applied(found.state, words_of("accept 'heave test'"), *found.session), core::InputError);
    auto stored = std::make_shared<Session>(*found.session);
    stored->results.documents.emplace_back("found-model/heave test", files.dump());
    const State accepted = applied(found.state, words_of("accept 'heave test'"), *stored);
    const SessionPointer with = with_models(stored, accepted.accepted);
    EXPECT_EQ(core::read_file(with->study.measurements.front().model), model);
    EXPECT_NO_THROW(static_cast<void>(known_model(with->study.measurements.front().model)));
    EXPECT_FALSE(fs::exists(folder.path() / "report")) << "looking writes nothing into the study";
    cases::write_accepted(stored->study, cases::accept_model(stored->study, stored->results, "heave test"));
    EXPECT_EQ(core::read_file(folder.path() / "models" / "heave test" / "model.toml"), model);
}

TEST(AcceptedModels, AreWrittenIntoTheStudyWhichKeepsItsComments) {
    const core::TemporaryFolder folder;
    const Discovered found(folder.path());
    const auto accepted = cases::accept_model(found.session->study, found.session->results, "heave test");
    EXPECT_EQ(accepted.users, (std::vector<std::string>{"measurement 'heave test'"}));
    EXPECT_FALSE(fs::exists(folder.path() / accepted.model)) << "nothing is written yet";
    cases::write_accepted(found.session->study, accepted);
    const auto study = cases::Study::open(folder.path());
    EXPECT_EQ(study.measurements.front().model.lexically_normal(),
              (folder.path() / "models" / "heave test" / "model.toml").lexically_normal());
    EXPECT_TRUE(fs::exists(folder.path() / "models" / "heave test" / "jet_lift.csv"));
    EXPECT_FALSE(fs::exists(folder.path() / "models" / "heave test" / "next-experiment.csv"));
    const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '#'); };
    EXPECT_EQ(lines(core::read_file(folder.path() / "study.toml")), lines(core::read_file(evie() / "study.toml")));
    // An older report is none of this result.
    core::write_file(folder.path() / "report" / "discovery" / "heave test" / "discovery.json", "{}");
    EXPECT_THROW(cases::accept_model(found.session->study, found.session->results, "heave test"), core::InputError);
}

/// `count` lines of actions, of which most fit the shipped study.
std::vector<std::string> random_lines(unsigned seed, int count) {
    std::mt19937 random(seed);
    const auto actions = every_action();
    const auto share = [&] { return std::uniform_real_distribution<>(0, 1)(random); };
    std::vector<std::string> lines;
    for (int i = 0; i < count; ++i) {
        switch (random() % 6) {
            case 0:
                lines.push_back("undo");
                break;
            case 1:
                lines.push_back("redo");
                break;
            case 2:
                lines.push_back("set body.base_cut=" + std::to_string(0.5 + 0.4 * share()));
                break;
            case 3:
                lines.push_back("table lift net_weight=" + std::to_string(share()) + "N");
                break;
            case 4:
                lines.push_back("keep v" + std::to_string(random() % 8));
                break;
            default:
                lines.push_back(actions[random() % (actions.size() - 2)]);
                break;
        }
    }
    return lines;
}

TEST(StudioReplay, TheLogGivesTheSameStateAndHistory) {
    for (unsigned seed = 1; seed <= 5; ++seed) {
        History live(opened());
        std::string log;
        live.on_line = [&](const std::string& line) { log += line + "\n"; };
        int gesture = 0;
        for (const auto& line : random_lines(seed, 200)) {
            try {
                if (line == "undo" || line == "redo") {
                    line == "undo" ? live.undo() : live.redo();
                } else {
                    live.act(words_of(line), *evie_session(),
                             line.starts_with("set") ? std::to_string(gesture++ / 5) : "");
                }
            } catch (const core::Error&) {  // what cannot be done is not logged
            }
        }
        live.end_gesture();
        History again(opened());
        SessionPointer session = evie_session();
        replay("# a comment\n\n" + log, "test", again, session, [](const State&) { return evie_session(); });
        EXPECT_EQ(state_hash(*again.state()), state_hash(*live.state())) << "seed " << seed;
        EXPECT_EQ(again.position(), live.position()) << "seed " << seed;
        again.go_to(0);
        EXPECT_EQ(*again.state(), opened());
    }
}

TEST(StudioReplay, AWrongLineIsNamed) {
    History history;
    SessionPointer session = open_session({});
    try {
        replay("workspace tables\nworkspace nowhere\n", "a.log", history, session,
               [](const State& state) { return load_session(state, {}); });
        FAIL();
    } catch (const core::InputError& error) {
        EXPECT_EQ(error.place().text(), "a.log:2");
    }
    EXPECT_EQ(history.state()->workspace, "tables") << "what came before is done";
}

// What a line names may have gone since the program stopped; what cannot be opened ends the recovery all the same.
TEST(StudioReplay, RecoveryPassesOverWhatIsRefusedAndSaysIt) {
    History history(opened());
    SessionPointer session = evie_session();
    std::vector<std::string> refused;
    const std::string log = "workspace tables\nselect case/gone\naxes gap lift_forc\nundo\nundo\nworkspace loop\n";
    replay(
        log, "a.log", history, session, [](const State&) { return evie_session(); }, &refused);
    ASSERT_EQ(refused.size(), 3U);
    EXPECT_EQ(refused[0].rfind("select case/gone: there is no case 'gone'", 0), 0U) << refused[0];
    EXPECT_EQ(refused[2].rfind("undo: ", 0), 0U) << refused[2];
    EXPECT_EQ(history.state()->workspace, "loop");
    EXPECT_EQ(history.position(), 1U);
    EXPECT_THROW(replay("open /no/such/study\nworkspace tables\n", "a.log", history, session,
                        [](const State& state) { return load_session(state, {}); }),
                 core::Error);
}

TEST(StudioSessionFile, ReadsBackFromAnywhere) {
    const core::TemporaryFolder folder;
    const fs::path first = folder.path() / "a";
    fs::create_directories(first / "study");
    fs::copy(evie() / "study.toml", first / "study" / "study.toml");
    fs::copy(evie() / "shapes" / "ellipse.toml", first / "hull.toml");
    State state = opened();
    state.study = (first / "study").string();
    state.files = {"shape:" + (first / "hull.toml").string()};
    for (const char* line : {"star case/ellipse-h5-p0", "set body.base_cut=0.7", "table lift net_weight=0.1N",
                             "keep one", "region glide start=5mm,1mm/s", "fields range=-1:1"}) {
        state = applied(state, words_of(line), *evie_session());
    }
    write_session(state, first / "s.ubs");
    EXPECT_EQ(read_session(first / "s.ubs").state, state);
    EXPECT_EQ(core::read_file(first / "s.ubs").find(folder.path().string()), std::string::npos) << "paths are relative";

    fs::rename(first, folder.path() / "b");
    const auto moved = read_session(folder.path() / "b" / "s.ubs");
    EXPECT_EQ(moved.state.study, (folder.path() / "b" / "study").string());
    EXPECT_TRUE(moved.problems.empty());

    fs::rename(folder.path() / "b" / "study", folder.path() / "b" / "moved");
    const auto lost = read_session(folder.path() / "b" / "s.ubs");
    ASSERT_EQ(lost.missing, std::vector<std::string>{(folder.path() / "b" / "study").string()});
    const State found =
        applied(lost.state, {"locate", lost.missing[0], (folder.path() / "b" / "moved").string()}, *evie_session());
    EXPECT_EQ(found.study, (folder.path() / "b" / "moved").string());
}

TEST(StudioSessionFile, KeepsForeignKeysAndRefusesOtherFiles) {
    const core::TemporaryFolder folder;
    const fs::path file = folder.path() / "s.ubs";
    write_session({}, file);
    auto document = nlohmann::json::parse(core::read_file(file));
    document["of_another_program"] = 7;
    core::write_file(file, document.dump());
    write_session({}, file);
    EXPECT_EQ(nlohmann::json::parse(core::read_file(file))["of_another_program"], 7);
    for (const char* text : {"", "{}", "[1]", "{\"schema\": \"underbody-session\", \"version\": 99}",
                             "{\"schema\": \"underbody-session\", \"state\": {\"study\": 7}}"}) {
        core::write_file(file, text);
        EXPECT_THROW(read_session(file), core::InputError) << text;
    }
}

TEST(StudioRecovery, TheLogOfAProgramThatDiedIsFoundAndThatOfALivingOneIsNot) {
    const core::TemporaryFolder folder;
    int ready[2];
    ASSERT_EQ(::pipe(ready), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        ActionLog log(folder.path());
        log.append("workspace tables");
        log.append("operation gap=3mm");
        static_cast<void>(!::write(ready[1], "x", 1));
        ::_exit(9);  // no destructors: as a crash
    }
    char byte = 0;
    ASSERT_EQ(::read(ready[0], &byte, 1), 1);
    ::waitpid(child, nullptr, 0);
    {
        ActionLog mine(folder.path());
        mine.append("workspace loop");
        const auto logs = left_over_logs(folder.path());
        ASSERT_EQ(logs.size(), 1U);
        History history;
        SessionPointer session = open_session({});
        replay(core::read_file(logs[0]), logs[0].string(), history, session,
               [](const State& state) { return load_session(state, {}); });
        EXPECT_EQ(history.state()->workspace, "tables");
        EXPECT_DOUBLE_EQ(history.state()->design.gap, 0.003);
    }
    EXPECT_EQ(left_over_logs(folder.path()).size(), 1U) << "a program that ended in order leaves none";
}

}  // namespace
}  // namespace underbody::studio
