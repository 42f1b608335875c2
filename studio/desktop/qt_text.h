// Text of the libraries (UTF-8) for Qt.
#pragma once

#include <QString>
#include <string>

namespace underbody::studio {

inline QString qt(const std::string& text) { return QString::fromStdString(text); }
/// The same, safe inside rich text.
inline QString html(const std::string& text) { return qt(text).toHtmlEscaped(); }

}  // namespace underbody::studio
