// The 3D view of a field's surfaces: VTK behind a widget. Only on the window's thread.
#pragma once

#include <QString>
#include <QWidget>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "postproc/field/field.h"

namespace underbody::studio {

class Scene {
public:
    /// True when this machine can make an OpenGL context (asked once; VTK would abort without one).
    static bool possible();

    explicit Scene(QWidget* parent);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    [[nodiscard]] QWidget* widget() const;

    /// Shows the surfaces of a field; keeps the camera unless `refit`.
    void show(std::shared_ptr<const postproc::Field> field, bool refit);
    [[nodiscard]] const postproc::Field* field() const;

    /// One tick a zone of the field.
    void set_visible(const std::vector<bool>& zones);
    [[nodiscard]] bool visible(std::size_t zone) const;

    /// An array that can colour the surface: one component, or the size of a vector.
    struct Choice {
        std::string name;    ///< "pressure", "wall_shear", ...
        int component = -1;  ///< -1: the size of a vector, or the only component
        std::string label;   ///< for people
        std::string unit;
    };
    [[nodiscard]] std::vector<Choice> choices() const;

    /// Colours the visible zones. `whole_range` false: from the 1st to the 99th hundredth, so that single points at an
    /// edge do not take all the colours. An empty name: plain.
    void colour_by(const Choice& choice, bool whole_range);
    void show_edges(bool edges);
    /// Mirrors half models in the plane through the origin normal to "x", "y" or "z"; empty: not.
    void mirror(const std::string& axis);
    /// "bottom", "top", "side", "front", "iso" in the frame of the file.
    void look_from(const std::string& view, const std::string& forward, const std::string& up);

    /// Called with the value under the mouse at a click.
    std::function<void(const QString&)> on_pick;

    /// PNG bytes of what is seen, at twice the screen's resolution.
    std::string png();
    void render();

private:
    struct Parts;
    std::unique_ptr<Parts> parts_;
};

}  // namespace underbody::studio
