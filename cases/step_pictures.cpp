// Pictures of the flow on the surface of chosen cases.
#include <nlohmann/json.hpp>

#include "cases/case_loads.h"
#include "cases/engine.h"
#include "postproc/field/field.h"
#include "postproc/field/kinematic.h"
#include "postproc/loads/loads.h"
#include "postproc/views/views.h"

namespace underbody::cases {

namespace {

postproc::ViewOptions view_options(const Study& study, const PictureSpec& spec, const Case& entry) {
    postproc::ViewOptions options;
    options.forward = postproc::axis_from(study.forward);
    options.up = postproc::axis_from(study.up);
    options.symmetry = study.symmetry;
    options.zones = entry.zones;
    options.case_name = entry.conditions.label();
    options.speed = study.speed_of(entry).value_or(0);
    if (spec.range) {
        options.ranges = {{"pressure", *spec.range}};
    }
    return options;
}

Key picture_key(const std::string& kind, const Engine& engine, const PictureSpec& spec, const Case& entry) {
    Key key(kind, {"postproc"});
    key.add("file", engine.path_in_study(entry.file));
    key.add("forward", engine.study.forward).add("up", engine.study.up).add("symmetry", engine.study.symmetry);
    key.add("conditions", entry.conditions).add("picture", spec.name);
    key.add("reference_speed", engine.study.speed_of(entry).value_or(0));
    key.add("density", engine.study.density_of(entry).value_or(0));
    for (const auto& zone : entry.zones) {
        key.add("zone", zone);
    }
    add_units(key, entry);
    if (spec.range) {
        key.add("range", spec.range->first).add("range", spec.range->second);
    }
    return key;
}

/// The views that the spec names, or else all that the case allows, which is a result of its own.
std::vector<std::string> views_of(Engine& engine, const PictureSpec& spec, const Case& entry,
                                  Shared<postproc::Field>& field, const postproc::ViewOptions& options) {
    if (!spec.views.empty()) {
        return spec.views;
    }
    const auto made =
        engine.make("views", spec.name + "/" + entry.name, picture_key("views", engine, spec, entry),
                    [&] { return nlohmann::json(postproc::possible_views(field.get(), options)).dump(); });
    return made ? nlohmann::json::parse(engine.value(*made)).get<std::vector<std::string>>()
                : std::vector<std::string>();
}

void draw_case(Engine& engine, const PictureSpec& spec, const Case& entry) {
    Shared<postproc::Field> field(engine.states(), [&] {
        auto read = postproc::read_field(entry.file, read_options(entry), engine.progress);
        (void)postproc::bring_to_pascal(read, engine.study.density_of(entry));
        return read;
    });
    const postproc::ViewOptions options = view_options(engine.study, spec, entry);
    for (const auto& name : views_of(engine, spec, entry, field, options)) {
        Key key = picture_key("picture", engine, spec, entry);
        key.add("view", name);
        engine.picture("picture", spec.name + "/" + entry.name + "/" + name, key, [&] {
            const postproc::View view = postproc::view(field.get(), name, options, engine.progress);
            return nlohmann::json({{"title", view.title}, {"caption", spec.name + ": " + view.caption}}).dump() + "\n" +
                   view.png;
        });
    }
}

}  // namespace

void run_pictures(Engine& engine) {
    if (!engine.options.pictures) {
        return;
    }
    for (const auto& spec : engine.study.pictures) {
        const auto chosen = engine.study.select(spec.where);
        if (chosen.empty()) {
            engine.fail("picture", spec.name, "no case fits its 'where'");
        }
        for (const Case* entry : chosen) {
            draw_case(engine, spec, *entry);
        }
    }
}

}  // namespace underbody::cases
