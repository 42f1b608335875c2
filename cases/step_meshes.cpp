// Mesh uncertainty: the same case on several meshes.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "cases/engine.h"
#include "core/text.h"
#include "postproc/loads/deviation.h"
#include "postproc/loads/mesh_study.h"
#include "postproc/loads/uncertainty.h"

namespace underbody::cases {

namespace {

struct MeshRow {
    double cells = 0;
    std::size_t row = 0;
};

/// The rows of the loads that belong to the group, coarse to fine.
std::vector<MeshRow> rows_of(const Engine& engine, const MeshSpec& spec) {
    const core::Table& loads = engine.results.loads;
    std::vector<MeshRow> rows;
    if (loads.rows() == 0) {
        return rows;
    }
    const auto& names = loads.text("case");
    for (const Case* entry : engine.study.select(spec.where)) {
        const auto mesh = entry->conditions.text(spec.column);
        const auto found = std::find(names.begin(), names.end(), entry->name);
        for (const auto& [name, cells] : spec.cells) {
            if (mesh == name && found != names.end()) {
                rows.push_back({cells, static_cast<std::size_t>(found - names.begin())});
            }
        }
    }
    std::sort(rows.begin(), rows.end(), [](const MeshRow& a, const MeshRow& b) { return a.cells < b.cells; });
    return rows;
}

/// In what the cases differ besides their mesh: then they are not one mesh study.
std::vector<std::string> other_differences(const Engine& engine, const MeshSpec& spec,
                                           const std::vector<MeshRow>& rows) {
    const auto& names = engine.results.loads.text("case");
    std::optional<postproc::SetPoint> first;
    for (const Case* entry : engine.study.select(spec.where)) {
        const bool used =
            std::any_of(rows.begin(), rows.end(), [&](const MeshRow& row) { return names[row.row] == entry->name; });
        if (!used) {
            continue;
        }
        const auto point = postproc::set_point(entry->conditions.texts, entry->conditions.numbers, spec.column);
        if (first && *first != point) {
            return postproc::differences(*first, point);
        }
        first = point;
    }
    return {};
}

/// What the finest mesh's loads are measured by.
postproc::LoadScale scale_of(const core::Table& loads, std::size_t row) {
    const auto value = [&](const char* name) {
        const auto* column = loads.find(name);
        return column != nullptr && std::isfinite(column->numbers[row]) ? column->numbers[row] : 0.0;
    };
    return {postproc::resultant(value), value("reference_length")};
}

std::string compute_mesh(const Engine& engine, const MeshSpec& spec, const std::vector<MeshRow>& rows) {
    nlohmann::json document = {{"quantities", nlohmann::json::object()}, {"cells", nlohmann::json::array()}};
    for (const auto& row : rows) {
        document["cells"].push_back(row.cells);
    }
    for (const auto& quantity : spec.quantities) {
        const auto& column = engine.results.loads.numbers(quantity);
        std::vector<postproc::MeshValue> values;
        nlohmann::json shown = nlohmann::json::array();
        for (const auto& row : rows) {
            values.push_back({postproc::mesh_size(row.cells), column[row.row]});
            shown.push_back(column[row.row]);
        }
        nlohmann::json found;
        postproc::to_json(found, postproc::mesh_uncertainty_of(values, quantity.ends_with("_moment"),
                                                               scale_of(engine.results.loads, rows.back().row)));
        found["values"] = shown;
        document["quantities"][quantity] = std::move(found);
    }
    return document.dump();
}

}  // namespace

void run_meshes(Engine& engine) {
    for (const auto& spec : engine.study.mesh_uncertainties) {
        const auto rows = rows_of(engine, spec);
        if (rows.size() < 2) {
            engine.fail("mesh", spec.name, "fewer than two of its meshes have loads");
            continue;
        }
        if (const auto others = other_differences(engine, spec, rows); !others.empty()) {
            engine.fail("mesh", spec.name,
                        "its cases differ in '" + others.front() +
                            "' too, not in their mesh alone: choose those of one condition");
            continue;
        }
        const auto& files = engine.results.loads.text("case");
        Key key("mesh", {"postproc"});
        const postproc::LoadScale scale = scale_of(engine.results.loads, rows.back().row);
        key.add("force", scale.force).add("length", scale.length);
        for (const auto& row : rows) {
            key.add("cells", row.cells).through("loads", files[row.row]);
            for (const auto& quantity : spec.quantities) {
                key.add(quantity, engine.results.loads.numbers(quantity)[row.row]);
            }
        }
        if (const auto made = engine.make("mesh", spec.name, key, [&] { return compute_mesh(engine, spec, rows); })) {
            const std::string text = engine.value(*made);
            engine.results.meshes.push_back(mesh_result(spec.name, nlohmann::json::parse(text)));
            engine.add_document("mesh/" + spec.name, text);
        }
    }
}

}  // namespace underbody::cases
