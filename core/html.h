// One self-contained HTML page: text is escaped, pictures are embedded, numbers are aligned.
#pragma once

#include <string>
#include <vector>

namespace underbody::core {

class HtmlPage {
public:
    HtmlPage(std::string title, std::string subtitle);

    /// A section with an entry in the table of contents.
    void section(const std::string& title);
    void subsection(const std::string& title);
    void paragraph(const std::string& text);
    /// A remark that the reader must not miss.
    void warning(const std::string& text);
    /// Key figures side by side: {"0.27 N", "lift at 5 mm"}.
    struct Fact {
        std::string value;
        std::string label;
    };
    void facts(const std::vector<Fact>& facts);
    void list(const std::vector<std::string>& items);

    /// A table; cells that read as numbers are aligned right. `caption` may be empty.
    void table(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
               const std::string& caption = {});
    /// A long table, folded away behind its title.
    void folded_table(const std::string& title, const std::vector<std::string>& header,
                      const std::vector<std::vector<std::string>>& rows);

    struct Picture {
        std::string png;
        std::string caption;
        std::string alt;
    };
    void picture(const Picture& picture);
    /// Several pictures side by side where the page is wide enough.
    void pictures(const std::vector<Picture>& pictures);

    /// A link to a file beside the page.
    void link(const std::string& target, const std::string& text);

    [[nodiscard]] std::string text() const;

private:
    void table_body(const std::vector<std::string>& header, const std::vector<std::vector<std::string>>& rows,
                    const std::string& caption);
    std::string title_;
    std::string subtitle_;
    std::string body_;
    std::vector<std::string> sections_;
};

}  // namespace underbody::core
