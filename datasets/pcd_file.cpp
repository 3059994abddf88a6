// PCD, the format of the Point Cloud Library: DATA ascii, binary, and binary_compressed where liblzf is built in. VIEWPOINT is not applied,
// as in PCL.
#include "error.h"
#include "point_lines.h"

#ifdef HAUSBENCH_HAS_LZF
#include <liblzf/lzf.h>
#endif

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstring>
#include <map>
#include <sstream>

namespace hausbench::readers {
namespace {

struct Field {
    std::string name;
    char type = 'F';
    std::uint64_t size = 4, count = 1;
    std::uint64_t offset = 0, column = 0;  // in a record; of a text line
};

struct Header {
    std::vector<Field> fields;
    std::array<const Field*, 3> axes{};
    std::uint64_t points = 0, record = 0;  // how many; bytes of one
    std::string data;
    std::size_t end = 0;      // where the body begins
    std::uint32_t lines = 0;  // of the header
};

constexpr std::uint64_t most = std::uint64_t{1} << 40;

class HeaderReader {
public:
    HeaderReader(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes) {}

    Header read() {
        while (header_.data.empty()) {
            if (header_.end >= bytes_.size()) throw InputError(name_ + ": is no PCD file: it has no DATA line");
            const std::size_t end = std::min(bytes_.find('\n', header_.end), bytes_.size());
            std::string line(bytes_.substr(header_.end, std::min<std::size_t>(end - header_.end, 4096)));
            header_.end = std::min(end + 1, bytes_.size());
            ++header_.lines;
            line.resize(std::min(line.find('#'), line.size()));
            std::istringstream words(line);
            std::string key;
            if (words >> key) take(key, words);
        }
        settle();
        return std::move(header_);
    }

private:
    [[noreturn]] void refuse(const std::string& why) const {
        throw InputError(fmt::format("{}: line {}: {}", name_, header_.lines, why));
    }

    void take(const std::string& key, std::istringstream& words) {
        std::vector<std::string> values;
        for (std::string word; words >> word;) values.push_back(word);
        if (key == "VERSION" || key == "VIEWPOINT") return;
        const auto one = [&]() -> const std::string& {
            return values.size() == 1 ? values.front() : (refuse(key + " needs one value"), values.front());
        };
        if (key == "FIELDS" || key == "COLUMNS") {
            for (const std::string& value : values) header_.fields.push_back({value});
        } else if (key == "SIZE" || key == "TYPE" || key == "COUNT") {
            if (values.size() != header_.fields.size())
                refuse(fmt::format("{} has {} values for {} FIELDS", key, values.size(), header_.fields.size()));
            for (std::size_t i = 0; i < values.size(); ++i) {
                Field& field = header_.fields[i];
                if (key == "TYPE")
                    field.type = values[i].front();
                else
                    (key == "SIZE" ? field.size : field.count) = whole(values[i]);
            }
        } else if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS") {
            counts_[key] = whole(one());
        } else if (key == "DATA") {
            header_.data = one();
        } else {
            refuse(fmt::format("'{}' is no word of a PCD header: is it a PCD file?", one_line(key.substr(0, 40))));
        }
    }

    std::uint64_t whole(const std::string& text) const {
        std::uint64_t value = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
        if (error != std::errc() || end != text.data() + text.size() || value > most)
            refuse(fmt::format("'{}' is no whole number up to 2^40", one_line(text.substr(0, 40))));
        return value;
    }

    void settle() {
        std::uint64_t column = 0;
        for (Field& field : header_.fields) {
            field.offset = header_.record;
            field.column = column;
            if (field.size > most / 1024 || field.count > 1024) refuse("a field is larger than any point: damaged");
            header_.record += field.size * field.count;
            column += field.count;
        }
        for (std::size_t k = 0; k < 3; ++k) {
            for (const Field& field : header_.fields)
                if (field.name == std::string(1, "xyz"[k])) header_.axes[k] = &field;
            const Field* axis = header_.axes[k];
            if (!axis) refuse(fmt::format("FIELDS has no '{}'", "xyz"[k]));
            const std::string kind = fmt::format("{}{}", axis->type, axis->size);
            static const std::string known = " F4 F8 I1 I2 I4 I8 U1 U2 U4 U8 ";
            if (axis->count != 1 || known.find(" " + kind + " ") == std::string::npos)
                refuse(fmt::format("'{}' is of type {} and count {}: write it as one F of 4 or 8 bytes", axis->name,
                                   kind, axis->count));
        }
        const bool shaped = counts_.contains("WIDTH") && counts_.contains("HEIGHT");
        const std::uint64_t width = counts_["WIDTH"], height = counts_["HEIGHT"];
        if (!counts_.contains("POINTS") && !shaped) refuse("the header has neither POINTS nor WIDTH and HEIGHT");
        if (height > 0 && width > most / height) refuse("WIDTH times HEIGHT is more points than any file has");
        header_.points = counts_.contains("POINTS") ? counts_["POINTS"] : width * height;
        if (shaped && header_.points != width * height)
            refuse(fmt::format("POINTS is {}, and WIDTH times HEIGHT {}", header_.points, width * height));
    }

    const std::string& name_;
    std::string_view bytes_;
    Header header_;
    std::map<std::string, std::uint64_t> counts_;
};

template <class T> double value_at(const char* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
}

double value_of(const Field& field, const char* at) {
    if (field.type == 'F') return field.size == 4 ? value_at<float>(at) : value_at<double>(at);
    const bool sign = field.type == 'I';
    switch (field.size) {
        case 1:
            return sign ? value_at<std::int8_t>(at) : value_at<std::uint8_t>(at);
        case 2:
            return sign ? value_at<std::int16_t>(at) : value_at<std::uint16_t>(at);
        case 4:
            return sign ? value_at<std::int32_t>(at) : value_at<std::uint32_t>(at);
        default:
            return sign ? value_at<std::int64_t>(at) : value_at<std::uint64_t>(at);
    }
}

// The address of a field of a point: record by record, or field by field in a compressed file.
Soup from_binary(const std::string& name, const Header& header, std::string_view body, bool by_field) {
    if (header.points > 0 && body.size() / header.points < header.record)
        throw InputError(fmt::format("{}: is truncated: {} points of {} bytes are announced, and {} bytes are there",
                                     name, header.points, header.record, body.size()));
    Soup soup;
    soup.points.reserve(header.points);
    for (std::uint64_t i = 0; i < header.points; ++i) {
        Vec3 point;
        for (std::size_t k = 0; k < 3; ++k) {
            const Field& field = *header.axes[k];
            const std::uint64_t at =
                by_field ? field.offset * header.points + i * field.size : i * header.record + field.offset;
            point[static_cast<Eigen::Index>(k)] = value_of(field, body.data() + at);
        }
        soup.points.push_back(point);
    }
    return soup;
}

std::string inflated(const std::string& name, std::string_view body) {
#ifdef HAUSBENCH_HAS_LZF
    std::uint32_t packed = 0, full = 0;
    if (body.size() >= 8) std::memcpy(&packed, body.data(), 4), std::memcpy(&full, body.data() + 4, 4);
    if (body.size() < 8 || body.size() - 8 < packed)
        throw InputError(fmt::format("{}: is truncated: {} compressed bytes are announced, and {} are there", name,
                                     packed, body.size() < 8 ? 0 : body.size() - 8));
    // LZF writes at most 264 bytes for each 3 that it reads: a larger number is damage, and would only take memory.
    if (full / 88 > packed) throw InputError(name + ": is damaged: its bytes cannot inflate to what it announces");
    std::string out(full, '\0');
    if (lzf_decompress(body.data() + 8, packed, out.data(), full) != full)
        throw InputError(name + ": is damaged: its compressed bytes cannot be inflated");
    return out;
#else
    (void)body;
    throw InputError(name +
                     ": its data are binary_compressed, which this build does not read: write it as binary, or install "
                     "liblzf-dev and build again");
#endif
}

}  // namespace

Soup read_pcd(const std::string& name, std::string_view bytes) {
    const Header header = HeaderReader(name, bytes).read();
    const std::string_view body = bytes.substr(header.end);
    Soup soup;
    if (header.data == "ascii") {
        PointLines points(name, {header.axes[0]->column, header.axes[1]->column, header.axes[2]->column},
                          header.points);
        each_text_line(body, header.lines + 1, [&](std::string_view line, std::uint32_t n) { points.add(line, n); });
        soup = points.finish();
    } else if (header.data == "binary") {
        soup = from_binary(name, header, body, false);
    } else if (header.data == "binary_compressed") {
        const std::string fields = inflated(name, body);
        // From another number of points each field would begin elsewhere.
        if (fields.size() > header.points * header.record)
            throw InputError(fmt::format("{}: is damaged: {} points of {} bytes are announced, and {} bytes are there",
                                         name, header.points, header.record, fields.size()));
        soup = from_binary(name, header, fields, true);
    } else {
        throw InputError(fmt::format("{}: line {}: unknown DATA '{}'{}", name, header.lines,
                                     one_line(header.data.substr(0, 40)),
                                     nearest_hint(header.data, {"ascii", "binary", "binary_compressed"})));
    }
    for (const Field* axis : header.axes) soup.float32 = soup.float32 || (axis->type == 'F' && axis->size == 4);
    for (std::size_t i = 0; i < soup.points.size(); ++i)
        if (!soup.points[i].allFinite())
            throw InputError(fmt::format(
                "{}: {}point {} (from 0) is not finite, which marks a missing measurement in PCD: remove such points "
                "first",
                name, soup.point_lines.empty() ? "" : fmt::format("line {}: ", soup.point_lines[i]), i));
    return soup;
}

}  // namespace hausbench::readers
