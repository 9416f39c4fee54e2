#include "meshes/ply_header.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <set>
#include <sstream>
#include <string_view>
#include <vector>

namespace tristim {

namespace {

const std::set<std::string> real_types = {"float", "float32", "double", "float64"};
const std::map<std::string, std::size_t> type_bytes = {{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},
                                                       {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
                                                       {"int", 4},   {"uint", 4},    {"int32", 4},  {"uint32", 4},
                                                       {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
const std::set<std::string> integer_types = {"char", "uchar", "short", "ushort", "int",   "uint",
                                             "int8", "uint8", "int16", "uint16", "int32", "uint32"};
/// Types of the number of corners of a face that OpenMesh reads.
const std::set<std::string> count_types = {"uchar", "uint8", "uint16", "int"};
const std::set<std::string> position_names = {"x", "y", "z"};
const std::set<std::string> normal_names = {"nx", "ny", "nz"};
/// Names that pbrt takes for texture coordinates; OpenMesh knows the first pair.
const std::array<std::array<std::string, 2>, 4> uv_names = {
    {{"u", "v"}, {"s", "t"}, {"texture_u", "texture_v"}, {"texture_s", "texture_t"}}};

class HeaderReader {
  public:
    HeaderReader(const std::string& path, const std::string& bytes) : path_(path), bytes_(bytes) {}

    PlyHeader read();

  private:
    struct Element {
        struct Property {
            std::string type; ///< with the types of a list's entries
            std::string name;
        };
        std::string name;
        std::size_t count = 0;
        std::vector<Property> properties;

        bool has(const std::string& property) const;
    };

    template <typename... Args>
    [[noreturn]] void refuse(fmt::format_string<Args...> format, Args&&... args) const {
        fail("{}:{}: {}", path_, line_, fmt::format(format, std::forward<Args>(args)...));
    }

    bool next_line();
    void read_format();
    void read_element();
    void read_property();
    void read_list();
    const Element* find(const std::string& name) const;
    void check_elements() const;
    std::size_t least_row_bytes(const Element& element) const;
    void check_size() const;
    /// The names of the properties that are read, with the names that OpenMesh knows them by.
    std::map<std::string, std::string> needed_properties(const Element& element) const;
    std::string rewritten() const;

    const std::string& path_;
    const std::string& bytes_;
    std::size_t position_ = 0;
    int line_ = 0;
    std::vector<std::string> words_; ///< of the current line
    std::string format_;
    std::vector<Element> elements_;
};

bool HeaderReader::next_line() {
    const std::size_t end = bytes_.find('\n', position_);
    if (end == std::string::npos)
        return false;
    std::istringstream line(bytes_.substr(position_, end - position_));
    words_.clear();
    for (std::string word; line >> word;)
        words_.push_back(word);
    position_ = end + 1;
    ++line_;
    return true;
}

void HeaderReader::read_format() {
    const std::set<std::string> known = {"ascii", "binary_little_endian", "binary_big_endian"};
    if (words_.size() != 3 || !known.contains(words_[1]) || words_[2] != "1.0")
        refuse("the format of this PLY file is not supported");
    format_ = words_[1];
}

void HeaderReader::read_element() {
    Element element;
    if (words_.size() == 3) {
        element.name = words_[1];
        const auto [stop, error] =
            std::from_chars(words_[2].data(), words_[2].data() + words_[2].size(), element.count);
        if (error == std::errc() && *stop == '\0' && element.count <= 0xffffffffu && !find(element.name)) {
            elements_.push_back(std::move(element));
            return;
        }
    }
    refuse("this element of the PLY header is malformed or given twice");
}

void HeaderReader::read_list() {
    Element& element = elements_.back();
    if (words_.size() != 5 || element.name != "face" || (words_[4] != "vertex_indices" && words_[4] != "vertex_index"))
        refuse("a list other than \"vertex_indices\" of \"face\" is not supported");
    if (!count_types.contains(words_[2]) || !integer_types.contains(words_[3]))
        refuse("the types \"{}\" and \"{}\" of \"{}\" are not supported", words_[2], words_[3], words_[4]);
    // OpenMesh 9 forgets what stands before, and would take its values for indices.
    if (!element.properties.empty())
        refuse("\"{}\" must be the first property of \"face\" and the only list", words_[4]);
    element.properties.push_back({fmt::format("list {} {}", words_[2], words_[3]), "vertex_indices"});
}

void HeaderReader::read_property() {
    if (elements_.empty())
        refuse("this property of the PLY header belongs to no element");
    if (words_.size() > 1 && words_[1] == "list") {
        read_list();
        return;
    }
    Element& element = elements_.back();
    if (words_.size() != 3 || (!real_types.contains(words_[1]) && !integer_types.contains(words_[1])))
        refuse("this property of the PLY header is malformed");
    const std::string& name = words_[2];
    const bool is_needed = element.name == "vertex" && (position_names.contains(name) || normal_names.contains(name));
    if (is_needed && !real_types.contains(words_[1]))
        refuse("the property \"{}\" has the type \"{}\" where \"float\" or \"double\" is expected", name, words_[1]);
    if (element.has(name))
        refuse("the property \"{}\" is given twice", name);
    element.properties.push_back({words_[1], name});
}

bool HeaderReader::Element::has(const std::string& property) const {
    return std::any_of(properties.begin(), properties.end(), [&](const Property& p) { return p.name == property; });
}

const HeaderReader::Element* HeaderReader::find(const std::string& name) const {
    const auto it = std::find_if(elements_.begin(), elements_.end(), [&](const Element& e) { return e.name == name; });
    return it == elements_.end() ? nullptr : &*it;
}

void HeaderReader::check_elements() const {
    const Element* vertex = find("vertex");
    const Element* face = find("face");
    if (format_.empty() || !vertex || !face || face < vertex)
        fail("{}: the PLY header needs a format, an element \"vertex\" and after it an element \"face\"", path_);
    const auto has = [vertex](const std::string& name) { return vertex->has(name); };
    if (!std::all_of(position_names.begin(), position_names.end(), has))
        fail("{}: the vertices of this PLY file lack \"x\", \"y\" or \"z\"", path_);
    if (std::any_of(normal_names.begin(), normal_names.end(), has) &&
        !std::all_of(normal_names.begin(), normal_names.end(), has))
        fail("{}: the vertices of this PLY file have some of \"nx\", \"ny\" and \"nz\", but not all", path_);
    if (!face->has("vertex_indices"))
        fail("{}: the faces of this PLY file lack \"vertex_indices\"", path_);
}

/// The bytes of a line of an element, without the entries of its list; in a text file, of single digits with blanks.
std::size_t HeaderReader::least_row_bytes(const Element& element) const {
    std::size_t bytes = 0;
    for (const auto& [type, name] : element.properties) {
        const std::string first = type.starts_with("list ") ? type.substr(5, type.find(' ', 5) - 5) : type;
        bytes += format_ == "ascii" ? 2 : type_bytes.at(first);
    }
    return bytes;
}

/// The reader makes as many vertices and faces as the header says, whatever the file holds.
void HeaderReader::check_size() const {
    std::size_t left = bytes_.size() - position_ + 1; // the last line of a text may have no end
    for (const Element& element : elements_) {
        const std::size_t row = least_row_bytes(element);
        if (element.count > 0 && (row == 0 || element.count > left / row))
            fail("{}: the PLY file is cut short or malformed: its {} bytes cannot hold {} lines of \"{}\"", path_,
                 bytes_.size(), element.count, element.name);
        left -= element.count * row;
        // What follows the faces is not read.
        if (element.name == "face")
            break;
    }
}

std::map<std::string, std::string> HeaderReader::needed_properties(const Element& element) const {
    std::map<std::string, std::string> needed;
    if (element.name == "face")
        needed["vertex_indices"] = "vertex_indices";
    if (element.name != "vertex")
        return needed;
    for (const auto& names : {position_names, normal_names}) {
        for (const std::string& name : names)
            needed[name] = name;
    }
    for (const auto& names : uv_names) {
        if (!element.has(names[0]) || !element.has(names[1]))
            continue;
        for (const auto& [type, name] : element.properties) {
            if ((name == names[0] || name == names[1]) && !real_types.contains(type))
                fail("{}: the property \"{}\" has the type \"{}\" where \"float\" or \"double\" is expected", path_,
                     name, type);
        }
        for (std::size_t i = 0; i < 2; ++i)
            needed[names[i]] = uv_names[0][i];
        break;
    }
    return needed;
}

std::string HeaderReader::rewritten() const {
    std::string text = fmt::format("ply\nformat {} 1.0\n", format_);
    for (const Element& element : elements_) {
        text += fmt::format("element {} {}\n", element.name, element.count);
        const std::map<std::string, std::string> needed = needed_properties(element);
        for (std::size_t i = 0; i < element.properties.size(); ++i) {
            const auto& [type, name] = element.properties[i];
            const auto it = needed.find(name);
            text +=
                fmt::format("property {} {}\n", type, it == needed.end() ? fmt::format("ignored{}", i) : it->second);
        }
        // OpenMesh reads nothing after the faces.
        if (element.name == "face")
            break;
    }
    return text + "end_header\n";
}

PlyHeader HeaderReader::read() {
    if (!next_line() || words_.size() != 1 || words_[0] != "ply")
        fail("{}: this is not a PLY file: it does not begin with \"ply\"", path_);
    for (;;) {
        if (!next_line())
            fail("{}: the header of this PLY file has no \"end_header\"", path_);
        const std::string keyword = words_.empty() ? "" : words_[0];
        if (keyword == "end_header")
            break;
        if (keyword == "format")
            read_format();
        else if (keyword == "element")
            read_element();
        else if (keyword == "property")
            read_property();
        else if (keyword != "comment" && keyword != "obj_info")
            refuse("unknown keyword \"{}\" in the PLY header", keyword);
    }
    check_elements();
    check_size();
    return {find("vertex")->count, find("face")->count, rewritten(), position_};
}

} // namespace

PlyHeader read_ply_header(const std::string& path, const std::string& bytes) {
    return HeaderReader(path, bytes).read();
}

} // namespace tristim
