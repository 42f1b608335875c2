// Stability maps: the declared model with the study's force tables, and where each start ends.
#include <cmath>
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "cases/names_in_study.h"
#include "cases/region_model.h"
#include "core/file.h"
#include "surrogates/dynamics/basin/region.h"
#include "surrogates/dynamics/model/model.h"

namespace underbody::cases {

namespace {

namespace fs = std::filesystem;

/// The model as files beside the report, so that the user can go on with it.
void write_model_files(Engine& engine, const RegionSpec& spec, const Key& key) {
    const auto made = engine.make("model", spec.name, key, [&] {
        const Scratch tables;
        const Scratch written;
        dynamics::write_model(region_model(engine.study, spec, engine.results, tables.path()),
                              written.path() / "model.toml");
        nlohmann::json files = nlohmann::json::object();
        for (const auto& entry : fs::recursive_directory_iterator(written.path())) {
            if (entry.is_regular_file()) {
                files[entry.path().lexically_relative(written.path()).generic_string()] = core::read_file(entry.path());
            }
        }
        return files.dump();
    });
    if (!made || engine.mode == Engine::Mode::look) {
        return;
    }
    const auto files = nlohmann::json::parse(engine.value(*made));
    for (const auto& [file, text] : files.items()) {
        Engine::write_if_changed(engine.report_folder() / "models" / spec.name / file, text.get<std::string>());
    }
}

/// What the model's files hold is noted when it is read; the study's tables are no files.
Key region_key(const std::string& kind, const Engine& engine, const RegionSpec& spec) {
    Key key(kind, {"surrogates/tables", "surrogates/dynamics"});
    key.add("model", engine.path_in_study(spec.model));
    for (const auto& name : spec.forces) {
        const TableSpec& table = *engine.study.find_table(name);
        key.add("force", table.quantity)
            .add("fit", table.fit)
            .add("speed_exponent", table.speed_exponent)
            .through("table", name);
        for (const auto& axis : table.axes) {
            key.add("axis", axis);
        }
        const core::Table points = table_points(table, engine.results);
        key.add("points of '" + name + "'", digest_of(points));
        for (const std::string& comment : points.comments) {
            key.add("said of them", comment);
        }
        if (const auto range = range_in_cases(table, engine.results, "density")) {
            key.add("density from", range->first).add("density to", range->second);
        }
        key.add("density", engine.study.reference.number("density").value_or(NAN));
    }
    return key;
}

void run_one_region(Engine& engine, const RegionSpec& spec) {
    Key key = region_key("region", engine, spec);
    for (const auto& name : spec.forces) {  // a remark says where the model's are others
        const TableSpec& table = *engine.study.find_table(name);
        key.add("net_weight", table.net_weight.value_or(NAN)).add("virtual_mass", table.virtual_mass);
    }
    key.add("axes", spec.axes).add("for", spec.duration).add("columns", spec.columns).add("rows", spec.rows);
    auto beside_tables = nlohmann::json::array();  // what the map takes otherwise than the study's tables
    std::string scratch_folder;                    // a path of this moment, which a remark about a table may name
    Shared<dynamics::StabilityRegion> region(engine.states(), [&] {
        const Scratch scratch;
        scratch_folder = scratch.path().string() + "/";
        const auto model =
            named_in_study(engine, region_model(engine.study, spec, engine.results, scratch.path()), spec.model);
        for (const auto& remark : model.remarks) {
            // Said of the whole model, not of a line or a table: where the study's tables and the model do not fit.
            if (remark.severity == core::Problem::Severity::warning && remark.place.file == model.name &&
                !remark.place.line) {
                beside_tables.push_back(remark.message);
            }
        }
        return dynamics::stability_region(model, region_options(spec), engine.progress);
    });
    const auto made = engine.make("region", spec.name, key, [&] {
        nlohmann::json document;
        dynamics::to_json(document, region.get());
        document["beside_tables"] = beside_tables;
        std::string text = document.dump();
        for (auto at = text.find(scratch_folder); at != std::string::npos; at = text.find(scratch_folder, at)) {
            text.erase(at, scratch_folder.size());
        }
        return text;
    });
    if (!made) {
        return;
    }
    const std::string text = engine.value(*made);
    engine.results.regions.push_back(region_result(spec.name, nlohmann::json::parse(text)));
    engine.add_document("region/" + spec.name, text);
    key.from(*made);
    engine.figure("region/" + spec.name, key, [&] { return dynamics::region_figure(region.get()); });
    if (engine.options.write_report) {
        Key of_model = region_key("model", engine, spec);
        of_model.add("title", engine.study.title).add("origin", engine.study.origin);
        write_model_files(engine, spec, of_model);
    }
}

}  // namespace

void run_regions(Engine& engine) {
    for (const auto& spec : engine.study.regions) {
        try {
            run_one_region(engine, spec);
        } catch (const core::InputError& error) {
            engine.fail("region", spec.name, error.what());
        } catch (const core::UsageError& error) {
            engine.fail("region", spec.name, error.what());
        }
    }
}

}  // namespace underbody::cases
