// Loads of the shapes that a [[table]] names, by the surrogates of [design].
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "cases/design.h"
#include "cases/engine.h"
#include "cases/shape_loads.h"
#include "core/hash.h"

namespace underbody::cases {

namespace {

using SharedLoads = Shared<std::shared_ptr<const LearnedLoads>>;

/// What of [design] the surrogates are made with, and by what rows of results.csv are told from those of something
/// else; what the files hold is noted when they are read.
std::string digest_of_search(const Engine& engine) {
    const DesignSpec& spec = *engine.study.design;
    core::Hasher hash;
    hash.add(engine.path_in_study(spec.shape)).add(engine.path_in_study(spec.folder)).add(engine.study.symmetry);
    hash.add(engine.study.reference.number("density").value_or(NAN));
    if (engine.study.moments_about) {
        std::for_each(engine.study.moments_about->begin(), engine.study.moments_about->end(),
                      [&](double x) { hash.add(x); });
    }
    for (const auto& v : spec.variables) {
        hash.add(v.name).add(v.lower).add(v.upper).add(v.logarithmic ? 1 : 0);
    }
    for (const auto& tie : spec.ties) {
        hash.add(tie.key).add(tie.of).add(tie.factor).add(tie.offset);
    }
    for (const auto* values : {&spec.gaps, &spec.pitches, &spec.speeds, &spec.jet.values}) {
        hash.add("condition");
        for (const double value : *values) {
            hash.add(value);
        }
    }
    hash.add(spec.jet.quantity).add(spec.kinematic_viscosity);
    for (const auto& fidelity : spec.fidelities) {
        const CaseMesh& mesh = fidelity.mesh;
        hash.add(fidelity.name).add(mesh.mesher).add(mesh.density).add(mesh.cell);
        hash.add(mesh.surface_level).add(mesh.layers).add(mesh.iterations);
    }
    return hash.digest();
}

core::Table with_relative_error(const core::Table& points, const TableSpec& spec) {
    const std::string name = spec.quantity + "_sigma";
    const auto& values = points.numbers(spec.quantity);
    std::vector<double> sigmas(points.rows(), 0);
    if (const auto* stated = points.find(name)) {
        sigmas = stated->numbers;
    }
    for (std::size_t i = 0; i < sigmas.size(); ++i) {
        sigmas[i] = std::hypot(sigmas[i], spec.relative_sigma * values[i]);
    }
    core::Table wider;
    wider.comments = points.comments;
    for (const core::Column& column : points.columns()) {
        if (column.name != name) {
            wider.add_numbers(column.name, column.unit, column.numbers, column.written_unit);
        }
    }
    wider.add_numbers(name, core::find_quantity(spec.quantity)->unit, std::move(sigmas));
    return wider;
}

std::string compute(Engine& engine, const TableSpec& spec, const LearnedLoads& known) {
    core::Table points =
        shape_points(known, geometry::read_shape(spec.shape), {{spec.quantity}, spec.axes, spec.where});
    if (spec.relative_sigma > 0) {
        points = with_relative_error(points, spec);
    }
    engine.progress.check();
    return nlohmann::json{{"points", core::write_csv(points)}, {"says", points.comments}}.dump();
}

}  // namespace

void run_shape_loads(Engine& engine) {
    std::map<std::string, SharedLoads> learned;  // tables of one quantity learn once
    for (const TableSpec& spec : engine.study.tables) {
        if (spec.shape.empty()) {
            continue;
        }
        auto& loads =
            learned
                .try_emplace(spec.quantity, engine.states(),
                             [&engine, quantity = spec.quantity] {
                                 return learned_loads(Design::open(engine.study), {quantity}, engine.progress);
                             })
                .first->second;
        Key key("shape loads", {"surrogates/tables", "geometry"});
        key.add("shape", engine.path_in_study(spec.shape))
            .add("quantity", spec.quantity)
            .add("where", spec.where)
            .add("relative_sigma", spec.relative_sigma)
            .add("design", digest_of_search(engine));
        for (const auto& axis : spec.axes) {
            key.add("axis", axis);
        }
        const auto made =
            engine.make("shape loads", spec.name, key, [&] { return compute(engine, spec, *loads.get()); });
        if (!made) {
            continue;
        }
        const auto document = nlohmann::json::parse(engine.value(*made));
        core::Table points = core::read_csv(document.at("points").get<std::string>(), spec.name);
        points.comments = document.at("says").get<std::vector<std::string>>();
        engine.results.shape_loads.emplace_back(spec.name, std::move(points));
    }
}

}  // namespace underbody::cases
