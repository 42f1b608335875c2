// Evaluates <external_reactions> as JSBSim does: functions over properties, tables with straight lines, forces at
// places of the structural frame.
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace underbody::test {

/// An element of XML: no namespaces, no entities, comments left out.
struct Xml {
    std::string name, text;
    std::map<std::string, std::string> attributes;
    std::vector<Xml> children;

    [[nodiscard]] const Xml* find(const std::string& child) const {
        for (const Xml& c : children) {
            if (c.name == child) {
                return &c;
            }
        }
        return nullptr;
    }
    [[nodiscard]] const Xml& get(const std::string& child) const {
        if (const Xml* found = find(child)) {
            return *found;
        }
        throw std::runtime_error(name + " has no " + child);
    }
    [[nodiscard]] double number(const std::string& child) const { return std::stod(get(child).text); }

    static Xml parse(const std::string& text) {
        std::size_t at = text.find("?>") + 2;
        return element(text, at);
    }

private:
    static void skip(const std::string& s, std::size_t& at) {
        while (at < s.size()) {
            if (std::isspace(static_cast<unsigned char>(s[at])) != 0) {
                ++at;
            } else if (s.compare(at, 4, "<!--") == 0) {
                at = s.find("-->", at) + 3;
            } else {
                return;
            }
        }
    }
    static Xml element(const std::string& s, std::size_t& at) {
        skip(s, at);
        if (s.at(at) != '<') {
            throw std::runtime_error("an element is missing at " + std::to_string(at));
        }
        Xml result;
        const std::size_t end = s.find('>', at);
        std::istringstream head(s.substr(at + 1, end - at - 1));
        head >> result.name;
        for (std::string rest; std::getline(head, rest, '"');) {
            const std::size_t equals = rest.find('=');
            std::string key = rest.substr(0, equals), value;
            key.erase(0, key.find_first_not_of(' '));
            std::getline(head, value, '"');
            if (equals != std::string::npos) {
                result.attributes[key] = value;
            }
        }
        at = end + 1;
        while (s.compare(at, 2, "</") != 0) {
            const std::size_t next = s.find('<', at);
            result.text += s.substr(at, next - at);
            at = next;
            if (s.compare(at, 4, "<!--") == 0) {
                at = s.find("-->", at) + 3;
            } else if (s.compare(at, 2, "</") != 0) {
                result.children.push_back(element(s, at));
            }
        }
        const std::string closing = s.substr(at + 2, s.find('>', at) - at - 2);
        if (closing != result.name) {
            throw std::runtime_error(result.name + " is closed by " + closing);
        }
        at = s.find('>', at) + 1;
        return result;
    }
};

class Jsbsim {
public:
    using Vector = std::array<double, 3>;

    Jsbsim(const Jsbsim&) = delete;
    Jsbsim& operator=(const Jsbsim&) = delete;
    explicit Jsbsim(const std::string& text) : root_(Xml::parse(text)) {
        if (root_.name != "external_reactions") {
            throw std::runtime_error("the file is not of external reactions");
        }
        for (const Xml& child : root_.children) {
            if (child.name == "property") {
                properties[trimmed(child.text)] = std::stod(child.attributes.at("value"));
            } else if (child.name == "function") {
                functions_[child.attributes.at("name")] = &child;
            }
        }
    }

    std::map<std::string, double>
        properties;  ///< to be set: the state of the vehicle in JSBSim's units, and the inputs of the file

    [[nodiscard]] double property(const std::string& name) const {
        if (const auto found = functions_.find(name); found != functions_.end()) {
            return of_function(*found->second);
        }
        return properties.at(name);
    }

    /// Body axes, lbf and lbf ft about the centre of gravity, which is the origin of the structural frame.
    [[nodiscard]] std::pair<Vector, Vector> reactions() const {
        Vector force{}, moment{};
        for (const Xml& child : root_.children) {
            if (child.name != "force" && child.name != "moment") {
                continue;
            }
            if (child.attributes.at("frame") != "BODY") {
                throw std::runtime_error("a frame that is not BODY");
            }
            const double size = of_function(child.get("function"));
            const Xml& way = child.get("direction");
            const Vector f{size * way.number("x"), size * way.number("y"), size * way.number("z")};
            if (child.name == "moment") {
                for (std::size_t k = 0; k < 3; ++k) {
                    moment[k] += f[k];
                }
                continue;
            }
            const Xml& place = child.get("location");
            const double feet = place.attributes.at("unit") == "M" ? 1 / 0.3048 : std::nan("");
            // Structural axes run aft, to starboard and up.
            const Vector arm{-feet * place.number("x"), feet * place.number("y"), -feet * place.number("z")};
            for (std::size_t k = 0; k < 3; ++k) {
                force[k] += f[k];
                moment[k] += arm[(k + 1) % 3] * f[(k + 2) % 3] - arm[(k + 2) % 3] * f[(k + 1) % 3];
            }
        }
        return {force, moment};
    }

private:
    static std::string trimmed(const std::string& text) {
        std::istringstream words(text);
        std::string word;
        words >> word;
        return word;
    }

    [[nodiscard]] double of_function(const Xml& function) const {
        for (const Xml& child : function.children) {
            if (child.name != "description") {
                return value(child);
            }
        }
        throw std::runtime_error("a function without content");
    }

    [[nodiscard]] double value(const Xml& e) const {
        if (e.name == "value") {
            return std::stod(e.text);
        }
        if (e.name == "property") {
            return property(trimmed(e.text));
        }
        if (e.name == "table") {
            return table(e);
        }
        std::vector<double> of;
        for (const Xml& child : e.children) {
            of.push_back(value(child));
        }
        const auto needs = [&](std::size_t count) {
            if (of.size() != count) {
                throw std::runtime_error(e.name + " with " + std::to_string(of.size()) + " arguments");
            }
        };
        if (e.name == "sin" || e.name == "cos" || e.name == "abs") {
            needs(1);
            return e.name == "sin" ? std::sin(of[0]) : e.name == "cos" ? std::cos(of[0]) : std::abs(of[0]);
        }
        if (e.name == "lt" || e.name == "gt") {
            needs(2);
            return (e.name == "lt" ? of[0] < of[1] : of[0] > of[1]) ? 1 : 0;
        }
        if (e.name == "or" && of.size() > 1) {
            return std::any_of(of.begin(), of.end(), [](double v) { return v > 0.5; }) ? 1 : 0;
        }
        if (e.name == "quotient" || e.name == "pow") {
            needs(2);
            return e.name == "pow" ? std::pow(of[0], of[1]) : of[0] / of[1];
        }
        if ((e.name != "sum" && e.name != "product" && e.name != "difference") || of.size() < 2) {
            throw std::runtime_error("JSBSim knows no " + e.name + " of " + std::to_string(of.size()));
        }
        double result = of[0];
        for (std::size_t i = 1; i < of.size(); ++i) {
            result = e.name == "sum" ? result + of[i] : e.name == "product" ? result * of[i] : result - of[i];
        }
        return result;
    }

    /// Held at the ends, straight lines between.
    [[nodiscard]] double table(const Xml& e) const {
        std::map<std::string, double> at;
        for (const Xml& child : e.children) {
            if (child.name == "independentVar") {
                at[child.attributes.at("lookup")] = property(trimmed(child.text));
            }
        }
        std::vector<double> breaks, values;
        for (const Xml& child : e.children) {
            if (child.name != "tableData") {
                continue;
            }
            values.push_back(at.size() == 1 ? line(child.text, at.at("row"))
                                            : plane(child.text, at.at("row"), at.at("column")));
            if (at.size() == 3) {
                breaks.push_back(std::stod(child.attributes.at("breakPoint")));
            }
        }
        return at.size() == 3 ? between(breaks, values, at.at("table")) : values.at(0);
    }

    static double between(const std::vector<double>& x, const std::vector<double>& y, double at) {
        if (!(at > x.front())) {
            return y.front();
        }
        if (at >= x.back()) {
            return y.back();
        }
        const auto i = static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin());
        const double t = (at - x[i - 1]) / (x[i] - x[i - 1]);
        return (1 - t) * y[i - 1] + t * y[i];
    }

    /// Parsed once.
    [[nodiscard]] const std::vector<std::vector<double>>& rows(const std::string& text) const {
        std::vector<std::vector<double>>& all = rows_[&text];
        if (!all.empty()) {
            return all;
        }
        std::istringstream lines(text);
        for (std::string line; std::getline(lines, line);) {
            std::istringstream numbers(line);
            std::vector<double> row;
            for (double v = 0; numbers >> v;) {
                row.push_back(v);
            }
            if (!row.empty()) {
                all.push_back(std::move(row));
            }
        }
        return all;
    }

    [[nodiscard]] double line(const std::string& text, double at) const {
        std::vector<double> x, y;
        for (const auto& row : rows(text)) {
            x.push_back(row.at(0));
            y.push_back(row.at(1));
        }
        return between(x, y, at);
    }

    [[nodiscard]] double plane(const std::string& text, double row_at, double column_at) const {
        const auto& all = rows(text);
        std::vector<double> x, y;
        for (std::size_t i = 1; i < all.size(); ++i) {
            x.push_back(all[i].at(0));
            y.push_back(between(all[0], {all[i].begin() + 1, all[i].end()}, column_at));
        }
        return between(x, y, row_at);
    }

    Xml root_;
    std::map<std::string, const Xml*> functions_;
    mutable std::map<const std::string*, std::vector<std::vector<double>>> rows_;
};

}  // namespace underbody::test
