#include "postproc/importers/fluent/fluent_settings.h"

#include <cmath>

#include "core/text.h"
#include "core/units.h"

namespace underbody::postproc {

namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The atom or string that begins at `at`.
std::string atom(std::string_view text, std::size_t at) {
    std::size_t end = at;
    if (at < text.size() && text[at] == '"') {
        end = text.find('"', at + 1);
        return std::string(text.substr(at + 1, end == std::string_view::npos ? end : end - at - 1));
    }
    while (end < text.size() && !is_blank(text[end]) && text[end] != '(' && text[end] != ')') {
        ++end;
    }
    return std::string(text.substr(at, end - at));
}

std::optional<double> lisp_number(std::string_view text, std::string_view name) {
    const auto value = lisp_value(text, name);
    return value ? core::parse_number(*value) : std::nullopt;
}

/// "(materials ((water-liquid fluid ... (density (constant . 998.2) ..." of the only fluid with a constant density.
std::optional<double> constant_density(std::string_view text) {
    const std::size_t materials = text.find("(materials ");
    if (materials == std::string_view::npos) {
        return {};
    }
    std::optional<double> found;
    int fluids = 0;
    int depth = 0;
    bool in_fluid = false;
    for (std::size_t i = materials; i < text.size(); ++i) {
        if (text[i] == '(') {
            ++depth;
            constexpr std::string_view key = "(density (constant . ";
            if (depth == 3) {
                const std::string name = atom(text, i + 1);
                std::size_t after = i + 1 + name.size();
                while (after < text.size() && is_blank(text[after])) {
                    ++after;
                }
                in_fluid = atom(text, after) == "fluid";
                fluids += in_fluid ? 1 : 0;
            } else if (in_fluid && text.substr(i, key.size()) == key) {
                found = core::parse_number(atom(text, i + key.size()));
            }
        } else if (text[i] == ')' && --depth == 0) {
            break;
        }
    }
    return fluids == 1 ? found : std::nullopt;
}

}  // namespace

std::optional<std::string> lisp_value(std::string_view text, std::string_view name) {
    for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1)) {
        std::size_t next = at + name.size();
        if (at == 0 || text[at - 1] != '(' || next >= text.size() || !is_blank(text[next])) {
            continue;
        }
        while (next < text.size() && is_blank(text[next])) {
            ++next;
        }
        if (next + 1 < text.size() && text[next] == '.' && is_blank(text[next + 1])) {
            next += 2;
        }
        while (next < text.size() && is_blank(text[next])) {
            ++next;
        }
        return atom(text, next);
    }
    return {};
}

void apply_settings(const FluentSettings& settings, bool with_values, Field& field) {
    const std::string_view text = settings.variables;
    const core::Place place{field.files.empty() ? std::string() : field.files.front(), {}, {}, {}};
    field.writer = settings.writer;
    if (with_values) {
        field.pressure.kind = PressureReference::Kind::gauge;
    }
    if (const auto pressure = lisp_number(text, "operating-pressure"); pressure && std::isfinite(*pressure)) {
        field.pressure.kind = PressureReference::Kind::gauge;
        field.pressure.operating_pressure = *pressure;
        field.metadata.emplace_back("operating pressure [Pa]", core::format_number(*pressure));
    } else if (with_values) {
        field.problems.push_back({core::Problem::Severity::note,
                                  "the case does not state its operating pressure; pressures are relative to it",
                                  place});
    }
    for (const char* name : {"reference-density", "reference-velocity", "reference-area", "reference-length",
                             "reference-viscosity", "reference-temperature", "flow-time", "time-step"}) {
        if (const auto value = lisp_value(text, name); value && core::parse_number(*value)) {
            field.metadata.emplace_back(name, *value);
        }
    }
    field.density = constant_density(text);
    if (field.dimension == 2) {
        const auto axi = lisp_value(text, "rp-axi?");
        field.metadata.emplace_back("axisymmetric", axi && *axi == "#t" ? "true" : axi ? "false" : "unknown");
    }
    for (const auto& note : settings.notes) {
        field.problems.push_back({core::Problem::Severity::note, note, place});
    }
    if (!settings.skipped.empty()) {
        std::string list;
        for (const auto& section : settings.skipped) {
            list += (list.empty() ? "" : ", ") + section;
        }
        field.problems.push_back(
            {core::Problem::Severity::note, "sections without meaning for this program: " + list, place});
    }
}

void scale_lengths(FaceMesh& mesh, const ReadOptions& options, Field& field) {
    const std::string unit =
        !options.length_unit.empty() && !mesh.length_unit_known ? options.length_unit : mesh.length_unit;
    if (unit.empty()) {
        field.problems.push_back(
            {core::Problem::Severity::note,
             "the mesh does not state its unit of length; taken as metres (a length unit can be given)",
             {mesh.file, {}, {}, {}}});
        field.metadata.emplace_back("length unit", "not stated, taken as m");
        return;
    }
    field.metadata.emplace_back("length unit", unit);
    const double scale = core::conversion(unit, "m", {mesh.file, {}, {}, {}}).scale;
    if (scale != 1) {
        for (auto& x : mesh.points) {
            x *= scale;
        }
    }
}

}  // namespace underbody::postproc
