// Stability maps: the declared model with the study's force tables, and where each start ends.
#include <nlohmann/json.hpp>

#include "cases/engine.h"
#include "cases/region_model.h"
#include "core/file.h"
#include "core/hash.h"
#include "surrogates/dynamics/model.h"
#include "surrogates/dynamics/region.h"

namespace underbody::cases {

namespace {

namespace fs = std::filesystem;

/// The model as files beside the report, so that the user can go on with it.
void write_model_once(Engine& engine, const RegionSpec& spec, const dynamics::Model& model, const Key& region_key) {
    const fs::path file = engine.report_folder() / "models" / spec.name / "model.toml";
    Key key("model", {});
    key.add(region_key.digest()).add(file.string());
    bool written = false;
    const auto write = [&] {
        dynamics::write_model(model, file);
        written = true;
        return file.string();
    };
    if (engine.make("model", spec.name, key, write) && !written && !fs::exists(file)) {
        write();
    }
}

void run_one_region(Engine& engine, const RegionSpec& spec) {
    const core::TemporaryFolder scratch;
    const dynamics::Model model = region_model(engine.study, spec, engine.results, scratch.path());
    Key key("region", {"surrogates/tables", "surrogates/dynamics"});
    key.add(engine.hash_of(spec.model)).add(spec.axes).add(spec.duration).add(spec.columns).add(spec.rows);
    for (const auto& name : spec.forces) {
        key.add(name);
    }
    for (const auto& force : model.forces) {
        key.add(core::content_hash_of_file(force.table_path));
    }
    std::optional<dynamics::StabilityRegion> region;
    const auto compute = [&] { return dynamics::stability_region(model, region_options(spec), engine.progress); };
    const auto made = engine.make("region", spec.name, key, [&] {
        region = compute();
        nlohmann::json document;
        dynamics::to_json(document, *region);
        return document.dump();
    });
    if (!made) {
        return;
    }
    engine.add_document("region/" + spec.name, *made);
    engine.figure("region/" + spec.name, key, [&] {
        if (!region) {
            region = compute();
        }
        return dynamics::region_figure(*region);
    });
    if (engine.options.write_report) {
        write_model_once(engine, spec, model, key);
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
