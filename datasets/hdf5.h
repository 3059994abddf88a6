// A thin RAII layer over the HDF5 C library that reads and writes whole columns.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace hausbench::h5 {

enum class Open { create, read };

// An HDF5 file. All functions throw std::runtime_error with the file, the object and the library's own message.
class File {
public:
    File(const std::filesystem::path& file, Open how);
    ~File();
    File(const File&) = delete;
    File& operator=(const File&) = delete;

    // Closes the file. A created file is in memory until then: this call writes it to disk in one piece, and flushes it
    // (fsync). Without this call nothing is written. Writing takes twice the size of the file in memory.
    void close();

    // Writes a dataset. `name` may contain groups ("cases/lower"), which are created as needed. If `columns` > 1, the
    // dataset is a matrix, whose values are given row by row.
    template <class T>  // double, or a signed or unsigned integer of 64 bits, or one of 32
    void write(const std::string& name, const std::vector<T>& values, std::size_t columns = 1);
    // Writes a dataset of variable-length UTF-8 strings.
    void write(const std::string& name, const std::vector<std::string>& values);

    std::vector<double> read_doubles(const std::string& name) const;
    // The next three read integers of any type, and throw if a value does not fit the type that they return.
    std::vector<std::int64_t> read_integers(const std::string& name) const;
    std::vector<std::uint64_t> read_unsigned(const std::string& name) const;
    std::vector<std::int32_t> read_indices(const std::string& name) const;
    std::vector<std::string> read_texts(const std::string& name) const;

    // Reads everything in the file once, and throws unless all of it is stored in this file as columns, tables and single
    // values of texts, integers and real numbers: without links, external or virtual data, and values that are not
    // stored. Other programs can then open the file, too. Needs the memory of the largest dataset.
    void expect_self_contained() const;

    bool has(const std::string& name) const;
    std::vector<std::string> children(const std::string& group) const;

    // Attributes of a group ("" or "/" is the root). Writing creates the group if needed and replaces an attribute of
    // the same name.
    void attribute(const std::string& group, const std::string& name, const std::string& value);
    void attribute(const std::string& group, const std::string& name, std::int64_t value);
    std::string text_attribute(const std::string& group, const std::string& name) const;
    std::int64_t integer_attribute(const std::string& group, const std::string& name) const;
    bool has_attribute(const std::string& group, const std::string& name) const;

private:
    void save() const;

    std::int64_t id_ = -1;  // hid_t
    std::filesystem::path path_;
    bool created_ = false;
};

}  // namespace hausbench::h5
