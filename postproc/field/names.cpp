// What the many programs call the same field variable.
#include "postproc/field/names.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>
#include <string_view>
#include <unordered_map>

#include "core/text.h"
#include "postproc/field/field.h"

namespace underbody::postproc {

namespace {

struct Known {
    const char* name;
    const char* unit;
    const char* spellings;  ///< folded (see `folded`), between blanks
};

// Spellings: CFX and CFD-Post, Fluent (data files, ASCII exports, EnSight descriptions), CGNS, OpenFOAM.
constexpr std::array known = {
    Known{"pressure", "Pa", "pressure sv_p static_pressure p pressure_corr solved_pressure gauge_pressure"},
    Known{"pressure_absolute", "Pa", "absolute_pressure abs_pressure pressure_absolute"},
    Known{"pressure_total", "Pa", "total_pressure pressure_total pressurestagnation ptot total_pressure_in_stn_frame"},
    Known{"pressure_dynamic", "Pa", "dynamic_pressure pressuredynamic pressure_dynamic"},
    Known{"pressure_coefficient", "1", "pressure_coefficient coefpressure cp_static"},
    Known{"kinematic_pressure", "m^2/s^2", "kinematic_pressure"},
    Known{"density", "kg/m^3", "density sv_density rho"},
    Known{"temperature", "K", "temperature sv_t static_temperature t"},
    Known{"temperature_total", "K", "total_temperature temperature_total temperaturestagnation"},
    Known{"velocity", "m/s", "velocity u velocity_vector water_velocity"},
    Known{"velocity_magnitude", "m/s", "velocity_magnitude velocitymagnitude"},
    Known{"vorticity", "1/s", "vorticity"},
    Known{"vorticity_magnitude", "1/s", "vorticity_magnitude vorticity_mag"},
    Known{"mach_number", "1", "mach_number mach sv_mach"},
    Known{"wall_shear", "Pa", "wall_shear wallshear wall_shear_stress wallshearstress shear_stress"},
    Known{"kinematic_wall_shear", "m^2/s^2", "kinematic_wall_shear"},
    Known{"wall_shear_magnitude", "Pa", "wall_shear_magnitude wall_shear_stress_magnitude"},
    Known{"wall_shear_force", "N", "sv_wall_shear wall_shear_force"},
    Known{"skin_friction_coefficient", "1", "skin_friction_coef skin_friction_coefficient skinfrictioncoefficient"},
    Known{"y_plus", "1", "yplus y_plus sv_yplus sv_wall_yplus sv_y_plus wall_yplus solver_yplus"},
    Known{"y_plus_u_tau", "1", "sv_yplus_utau sv_wall_yplus_utau"},
    Known{"wall_heat_flux", "W/m^2", "wall_heat_flux heat_flux wallheatflux total_surface_heat_flux"},
    Known{"wall_distance", "m", "wall_distance sv_wall_dist cell_wall_distance turbulentdistance"},
    Known{"wall_velocity", "m/s", "sv_wall_v sv_wall_velocity wall_velocity"},
    Known{"turbulence_kinetic_energy", "m^2/s^2",
          "turbulence_kinetic_energy turb_kinetic_energy turbulent_kinetic_energy turbulent_energy_kinetic "
          "turbulentenergykinetic "
          "sv_k k tke"},
    Known{"turbulence_dissipation_rate", "m^2/s^3",
          "turbulence_eddy_dissipation turb_diss_rate turbulent_dissipation_rate turbulentdissipation sv_d sv_epsilon "
          "epsilon"},
    Known{"specific_dissipation_rate", "1/s",
          "turbulence_eddy_frequency specific_diss_rate specific_dissipation_rate turbulentdissipationrate sv_o "
          "sv_omega omega"},
    Known{"kinematic_eddy_viscosity", "m^2/s", "nut sv_nut kinematic_eddy_viscosity turbulent_kinematic_viscosity"},
    Known{"eddy_viscosity", "Pa s",
          "eddy_viscosity viscosity_turb turbulent_viscosity viscosityeddy viscosityeddydynamic sv_mu_t sv_mut"},
    Known{"modified_turbulent_viscosity", "m^2/s",
          "nutilda sv_nut_sa modified_turb_viscosity modified_turbulent_viscosity"},
    Known{"viscosity", "Pa s",
          "dynamic_viscosity viscosity_lam molecular_viscosity viscositymolecular sv_mu_lam viscosity"},
    Known{"enthalpy", "J/kg", "static_enthalpy enthalpy sv_h"},
    Known{"volume_fraction", "1", "volume_fraction sv_vof vof"},
    Known{"mass_flux", "kg/s", "sv_flux mass_flow mass_flux"},
    Known{"area_vector", "m^2", "face_area area_vector normal_area"},
    Known{"cell_volume", "m^3", "cell_volume sv_volume volume"},
};

/// Small letters, every run of other characters one underscore.
std::string folded(std::string_view text) {
    std::string out;
    for (const char c : text) {
        const auto u = static_cast<unsigned char>(c);
        if (std::isalnum(u) != 0) {
            out += static_cast<char>(std::tolower(u));
        } else if (!out.empty() && out.back() != '_') {
            out += '_';
        }
    }
    while (!out.empty() && out.back() == '_') {
        out.pop_back();
    }
    return out;
}

const std::unordered_map<std::string, const Known*>& by_spelling() {
    static const auto map = [] {
        std::unordered_map<std::string, const Known*> result;
        for (const auto& entry : known) {
            result.emplace(entry.name, &entry);
            for (const auto word : core::split(entry.spellings, ' ')) {
                if (!word.empty()) {
                    result.emplace(std::string(word), &entry);
                }
            }
        }
        return result;
    }();
    return map;
}

struct Component {
    std::string base;
    int index;
};

/// "wall_shear_x", "x_wall_shear", "velocity_u", "velocityx", "sv_u": which vector, which component.
std::vector<Component> component_readings(const std::string& text) {
    std::vector<Component> readings;
    const auto axis = [](char c) {
        return c == 'x' || c == 'u' ? 0 : c == 'y' || c == 'v' ? 1 : c == 'z' || c == 'w' ? 2 : -1;
    };
    if (text.size() == 4 && text.starts_with("sv_") && axis(text[3]) >= 0 && text[3] >= 'u' && text[3] <= 'w') {
        return {{"velocity", axis(text[3])}};
    }
    if (text.size() == 1 && text[0] >= 'u' && text[0] <= 'w') {
        return {{"velocity", axis(text[0])}};
    }
    if (text.size() > 2 && axis(text.back()) >= 0) {
        const std::string_view front(text.data(), text.size() - 1);
        if (front.back() == '_') {
            readings.push_back({std::string(front.substr(0, front.size() - 1)), axis(text.back())});
        } else if (text.back() >= 'x') {
            readings.push_back({std::string(front), axis(text.back())});  // CGNS: VelocityX
        }
    }
    if (text.size() > 2 && text[1] == '_' && text[0] >= 'x' && text[0] <= 'z') {
        readings.push_back({text.substr(2), axis(text[0])});  // Fluent: x-velocity
    }
    return readings;
}

}  // namespace

CanonicalName canonical_name(const std::string& original) {
    const std::string key = folded(original);
    const auto& names = by_spelling();
    // OpenFOAM and Fluent keep some meanings in one letter; 'u' alone is the whole vector in OpenFOAM, written U.
    if (const auto whole = names.find(key); whole != names.end() && !(key == "u" && original == "u")) {
        return {whole->second->name, whole->second->unit};
    }
    static constexpr std::array suffix = {"_x", "_y", "_z"};
    for (const auto& [base, index] : component_readings(key)) {
        if (const auto vector = names.find(base); vector != names.end()) {
            return {vector->second->name + std::string(suffix[static_cast<std::size_t>(index)]), vector->second->unit};
        }
    }
    return {original, ""};
}

int spelling_rank(const std::string& original, const std::string& canonical) {
    const std::string key = folded(original);
    if (original == canonical || key == folded(canonical)) {
        return original == canonical ? 0 : 1;
    }
    std::vector<std::string> readings = {key};
    for (const auto& component : component_readings(key)) {
        readings.push_back(component.base);
    }
    constexpr int plainest = 2;
    constexpr int unknown = 1000;
    for (const auto& reading : readings) {
        if (const auto found = by_spelling().find(reading); found != by_spelling().end()) {
            const auto words = core::split(found->second->spellings, ' ');
            return plainest + static_cast<int>(std::find(words.begin(), words.end(), reading) - words.begin());
        }
    }
    return unknown;
}

std::optional<VectorComponent> vector_component(const std::string& name) {
    static constexpr std::array vectors = {"velocity",     "wall_shear",           "wall_shear_force",
                                           "vorticity",    "kinematic_wall_shear", "area_vector",
                                           "wall_velocity"};
    if (name.size() < 3 || name[name.size() - 2] != '_') {
        return {};
    }
    const int index = name.back() - 'x';
    if (index < 0 || index > 2) {
        return {};
    }
    const std::string base = name.substr(0, name.size() - 2);
    for (const char* vector : vectors) {
        if (base == vector) {
            return VectorComponent{base, index};
        }
    }
    return {};
}

bool matches(const std::string& pattern, const std::string& name) {
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    std::size_t p = 0;
    std::size_t n = 0;
    std::size_t star = std::string::npos;
    std::size_t resume = 0;
    while (n < name.size()) {
        if (p < pattern.size() && pattern[p] == '*') {
            star = p++;
            resume = n;
        } else if (p < pattern.size() && (pattern[p] == '?' || same(pattern[p], name[n]))) {
            ++p;
            ++n;
        } else if (star != std::string::npos) {
            p = star + 1;
            n = ++resume;
        } else {
            return false;
        }
    }
    while (p < pattern.size() && pattern[p] == '*') {
        ++p;
    }
    return p == pattern.size();
}

bool matches_any(const std::vector<std::string>& patterns, const std::string& name) {
    if (patterns.empty()) {
        return true;
    }
    for (const auto& pattern : patterns) {
        if (matches(pattern, name)) {
            return true;
        }
    }
    return false;
}

}  // namespace underbody::postproc
