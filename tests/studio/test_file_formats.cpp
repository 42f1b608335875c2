// The files that a user writes: templates are accepted by the real commands, each described key is read, each required
// key is told with a line that can be copied, and the pages in docs/files hold the same keys.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "cases/file_templates.h"
#include "cases/study.h"
#include "core/error.h"
#include "core/file.h"
#include "core/file_format.h"
#include "core/units.h"
#include "geometry/body/body_shape.h"
#include "geometry/body/variants.h"
#include "geometry/water/trim.h"
#include "surrogates/dynamics/model/effect.h"
#include "surrogates/dynamics/model/measurements.h"
#include "surrogates/dynamics/model/model.h"
#include "tests/support/support.h"

namespace underbody::test {
namespace {

namespace fs = std::filesystem;
using core::FileFormat;
using core::FileKey;
using core::FileTable;
using testing::HasSubstr;

class TemplateOf : public testing::TestWithParam<std::string> {};

TEST_P(TemplateOf, IsAcceptedByTheRealCommandAndNeverReplacesAFile) {
    const core::TemporaryFolder scratch;
    const std::string name = GetParam();
    const std::string file = name + ".toml";
    const ProgramRun made = run_underbody({"new", name, file}, scratch.path());
    ASSERT_EQ(made.exit_code, 0) << made.errors;
    const std::string written = core::read_file(scratch.path() / file);
    ASSERT_EQ(run_underbody({"new", "model", "its_model.toml"}, scratch.path()).exit_code, 0);
    const std::map<std::string, std::vector<std::string>> uses = {
        {"shape", {"body", file, "--out", "body.stl"}},
        {"study", {"study", "list", "."}},
        {"model", {"simulate", file, "--from", "gap=0.1", "--for", "1"}},
        {"dataset", {"predict", "its_model.toml", "--data", "."}},
    };
    const ProgramRun used = run_underbody(uses.at(name), scratch.path());
    EXPECT_EQ(used.exit_code, 0) << used.errors << "\n" << written;
    const ProgramRun again = run_underbody({"new", name, file}, scratch.path());
    EXPECT_EQ(again.exit_code, 3);
    EXPECT_THAT(again.errors, HasSubstr("already"));
    EXPECT_EQ(core::read_file(scratch.path() / file), written);
    for (const FileTable& table : cases::file_format(name).tables) {
        EXPECT_THAT(written, HasSubstr(table.one_line.empty() ? core::heading_of(table.path) : table.one_line));
        for (const FileKey& key : table.one_line.empty() ? table.keys : std::vector<FileKey>{}) {
            EXPECT_THAT(written, HasSubstr(key.name == "*" ? key.example : key.name + " = ")) << table.path;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(, TemplateOf, testing::Values("shape", "study", "model", "dataset"));

TEST(NewCommand, UsesTheUsualNameInAFolderAndWritesToStdout) {
    const core::TemporaryFolder scratch;
    const ProgramRun run = run_underbody({"new", "dataset", "--json"}, scratch.path());
    ASSERT_EQ(run.exit_code, 0) << run.errors;
    EXPECT_EQ(nlohmann::json::parse(run.output)["files"], nlohmann::json({"dataset.toml", "run-01.csv"}));
    EXPECT_EQ(run_underbody({"new", "dataset", "."}, scratch.path()).exit_code, 3);
    const ProgramRun shown = run_underbody({"new", "model", "-"}, scratch.path());
    EXPECT_THAT(shown.output, HasSubstr("[vehicle]"));
    const ProgramRun wrong = run_underbody({"new", "modle"}, scratch.path());
    EXPECT_EQ(wrong.exit_code, 2);
    EXPECT_THAT(wrong.errors, HasSubstr("'model'"));
}

/// A folder with everything that the examples of the formats name.
fs::path examples_in(const core::TemporaryFolder& scratch) {
    const fs::path folder = scratch.path();
    core::write_file(folder / "fields" / "ellipse-h5-p0.csv", "x\n");
    core::write_file(folder / "shapes" / "ellipse.toml",
                     "[body]\nlength = \"203.2 mm\"\nwidth = \"152 mm\"\nheight = \"145 mm\"\nbase_cut = 0.75\n");
    core::write_file(folder / "lift.csv", "gap [mm], lift_force [N]\n1, 0.6\n5, 0.3\n20, 0.1\n");
    core::write_file(folder / "points.csv", "Name,P1 - gap [mm]\nDP 5,5\n");
    core::write_file(folder / "run-01.csv", "time [s], gap [mm]\n0, 10\n15, 11\n20, 12\n25, 11\n30, 10\n");
    return folder;
}

std::string line_of(const FileKey& key) {
    return (key.name == "*" ? key.example : key.name + " = " + key.example) + "\n";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    return at == std::string::npos ? text : text.replace(at, what.size(), by);
}

/// Every table with its required keys, and one key more; without one key where `left_out` says so.
std::string document(const FileFormat& format, const FileTable& of, const FileKey* key, bool left_out) {
    std::string text;
    for (const FileTable& table : format.tables) {
        const bool here = &table == &of;
        // Keys that replace another one stand together without it.
        const std::string instead = here && key != nullptr && !left_out ? key->instead_of : "";
        const bool optional_part = !table.one_line.empty() && !table.required && !here;
        const bool empty_part =
            !here && !table.required &&
            std::none_of(table.keys.begin(), table.keys.end(), [](const FileKey& k) { return k.required(); });
        if (optional_part || empty_part || table.path == "vary[]" || table.path == "tie[]" ||
            (table.path == "effect[].*" && !here)) {
            if (!(here && (table.path == "vary[]" || table.path == "tie[]")) &&
                !(table.path == "vary[]" && of.path == "tie[]")) {
                continue;
            }
        }
        const std::string place = table.path.ends_with(".*") ? table.path.substr(0, table.path.size() - 1) +
                                                                   (table.path.starts_with("effect") ? "force"
                                                                    : table.path.starts_with("log")  ? "gap"
                                                                                                     : "speed")
                                                             : table.path;
        text += core::heading_of(place) + "\n";
        for (const FileKey& entry : table.keys) {
            const bool wanted = here && key != nullptr &&
                                (entry.name == key->name || (!instead.empty() && entry.instead_of == instead));
            if ((entry.required() && entry.name != instead && !(wanted && left_out)) || (wanted && !left_out)) {
                text += line_of(entry);
            }
        }
        // What the reader wants beside.
        if (table.path == "case[]" && of.path == "case[].parameters") {
            text += "design_points = \"points.csv\"\n";
        }
        if (table.path == "log.channel.*" && !(here && key != nullptr && key->name == "message")) {
            text += "message = \"RFND\"\n";
        }
        const bool of_curve =
            key != nullptr && (key->name == "curve" || key->name == "restoring" || key->name == "moment_at_most");
        if (table.path == "design" && of_curve) {
            text += "net_weight = \"0.3 N\"\nvirtual_mass = \"3.954 kg\"\n";
            text += "gap = [\"2 mm\", \"5 mm\", \"10 mm\"]\npitch = [\"-1 deg\", \"0 deg\", \"1 deg\"]\n";
        }
        if (here && of_curve) {  // limits are in the unit of the number
            text = replaced(text, "at_least = \"0.1 N\"", "at_least = 0.1");
            text += key->name != "curve" ? "curve = \"pitch_window\"\n" : "";
        }
        if (table.path == "sweep" && !(here && key != nullptr && key->name == "speed")) {
            text += "speed = \"0.5 m/s\"\n";
        }
        if (here && key != nullptr && (key->name == "base_length" || key->name == "base_width")) {
            text += "base = \"rectangle\"\n";
        }
        if (table.path == "mesh_uncertainty[].cells") {
            text += "coarse = 57280\n" + std::string(here ? "" : "fine = 374400\n");
        }
        if (table.path == "effect[]" && of.path != "effect[].*" && !(here && key != nullptr && key->name == "*")) {
            text += "force = \"0.01 N\"\n";
        }
    }
    if (text.find("design_points = ") != std::string::npos) {
        text = replaced(text, "h{gap:mm}", "h{design_point}");
    }
    return text;
}

void read_it(const std::string& format, const fs::path& file, bool variants) {
    if (format == "shape" && variants) {
        (void)geometry::read_variants(file);
    } else if (format == "shape") {
        (void)geometry::read_shape(file);
    } else if (format == "study") {
        (void)cases::Study::open(file);
    } else if (format == "model") {
        (void)dynamics::read_model(file);
    } else {
        (void)dynamics::read_measurements(file);
    }
}

class KeysOf : public testing::TestWithParam<std::string> {};

/// Of effects only some take these: see below.
bool only_some_effects(const FileTable& table, const FileKey& key) {
    return table.path == "effect[]" && (key.name == "quantity" || key.name == "parameter" || key.name == "table");
}

/// Of a search over several gaps: ShapeLoadsOfAStudy reads it.
bool needs_a_search(const FileTable& table, const FileKey& key) {
    return table.path == "table[]" && key.name == "shape";
}

TEST_P(KeysOf, AreAllReadAndTheirExamplesAreAccepted) {
    const core::TemporaryFolder scratch;
    const fs::path folder = examples_in(scratch);
    const FileFormat& format = cases::file_format(GetParam());
    const fs::path file = folder / format.file;
    for (const FileTable& table : format.tables) {
        for (const FileKey& key : table.keys) {
            if (only_some_effects(table, key) || needs_a_search(table, key)) {
                continue;
            }
            const std::string text = document(format, table, &key, false);
            core::write_file(file, text);
            EXPECT_NO_THROW(read_it(format.name, file, table.path == "vary[]" || table.path == "tie[]"))
                << table.path << " " << key.name << "\n"
                << text;
        }
    }
}

TEST_P(KeysOf, ThatAreMissingAreToldWithALineToCopy) {
    const core::TemporaryFolder scratch;
    const fs::path folder = examples_in(scratch);
    const FileFormat& format = cases::file_format(GetParam());
    const fs::path file = folder / format.file;
    for (const FileTable& table : format.tables) {
        for (const FileKey& key : table.keys) {
            if (!key.required()) {
                continue;
            }
            const std::string text = document(format, table, &key, true);
            core::write_file(file, text);
            try {
                read_it(format.name, file, table.path == "vary[]" || table.path == "tie[]");
                ADD_FAILURE() << table.path << " " << key.name << " is not missed in\n" << text;
            } catch (const core::InputError& error) {
                EXPECT_EQ(error.kind(), "missing") << error.what();
                EXPECT_THAT(error.hint(), HasSubstr(key.name + " = " + key.example)) << error.what();
            }
        }
    }
}

INSTANTIATE_TEST_SUITE_P(, KeysOf, testing::Values("shape", "study", "model", "dataset"));

TEST(KeysOfModel, OfSomeEffectsAreRead) {
    const core::TemporaryFolder scratch;
    const fs::path folder = examples_in(scratch);
    const std::string start = "[vehicle]\nmass = \"2.2 kg\"\n[[effect]]\n";
    for (const std::string& effect :
         {std::string("name = \"declared_parameter\"\nparameter = \"vehicle.mass\"\nvalue = \"2.1 kg\"\n"),
          std::string("name = \"unknown\"\ntable = \"lift.csv\"\n"),
          std::string("name = \"force_bias\"\nquantity = \"lift_force\"\nbias = \"0.01 N\"\n")}) {
        core::write_file(folder / "model.toml", start + effect);
        EXPECT_NO_THROW((void)dynamics::read_model(folder / "model.toml")) << effect;
    }
}

/// With UNDERBODY_WRITE_DOCS=1 the pages are written instead of compared.
TEST(DocumentedKeys, AreThoseOfTheReaders) {
    for (const FileFormat* format : cases::file_formats()) {
        const fs::path file = source_folder() / "docs" / "files" / (format->name + ".md");
        const std::string page = core::read_file(file);
        const std::string begin = "<!-- keys: " + format->name + " -->\n", end = "<!-- end of keys -->";
        const std::size_t from = page.find(begin), to = page.find(end);
        ASSERT_NE(from, std::string::npos) << file;
        ASSERT_NE(to, std::string::npos) << file;
        const std::string keys = "\n" + core::markdown_keys(*format) + "\n";
        const std::string fresh = page.substr(0, from + begin.size()) + keys + page.substr(to);
        if (std::getenv("UNDERBODY_WRITE_DOCS") != nullptr) {
            core::write_file(file, fresh);
        } else {
            EXPECT_EQ(page, fresh) << file << " is out of date: run this test with UNDERBODY_WRITE_DOCS=1";
        }
    }
}

TEST(ListCommand, ShowsTheRegistries) {
    const auto list = [](const std::vector<std::string>& what) {
        std::vector<std::string> arguments{"list", "--json"};
        arguments.insert(arguments.end(), what.begin(), what.end());
        const ProgramRun run = run_underbody(arguments);
        EXPECT_EQ(run.exit_code, 0) << run.errors;
        return nlohmann::json::parse(run.output).at(what[0]);
    };
    EXPECT_EQ(list({"quantities"}).size(), core::quantity_names().size());
    const auto effects = list({"effects"});
    EXPECT_EQ(effects.size(), dynamics::effects().size());
    for (const auto& effect : effects) {
        EXPECT_FALSE(effect["formula"].get<std::string>().empty()) << effect;
        for (const auto& parameter : effect["parameters"]) {
            EXPECT_FALSE(parameter["meaning"].get<std::string>().empty()) << effect;
        }
    }
    for (const char* what : {"views", "formats", "exports"}) {
        const auto rows = list({what});
        EXPECT_GE(rows.size(), 6U) << what;
        for (const auto& row : rows) {
            EXPECT_FALSE(row["meaning"].get<std::string>().empty()) << row;
        }
    }
    const auto keys = list({"keys", "shape"});
    EXPECT_EQ(keys[0]["name"], "length");
    EXPECT_EQ(keys[0]["unit"], "m");
    EXPECT_EQ(keys[0]["table"], "body");
    EXPECT_THAT(run_underbody({"list", "effects"}).output, HasSubstr("coulomb_friction"));
}

}  // namespace
}  // namespace underbody::test
