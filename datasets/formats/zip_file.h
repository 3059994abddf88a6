// ZIP archives in memory, for the readers of 3MF and AMF.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace hausbench::readers {

// Returns the path of a part of an archive in the form in which names are compared: without the first '/', with '/' for
// '\', %41 decoded, without "." and empty steps, and in lower case, because OPC compares names of parts so. Returns an
// empty string for a path that leads out of the archive or contains a zero byte.
std::string normal_part_name(std::string_view path);

// An archive whose entries are stored or deflated, with ZIP64 or without. Only the directory is read at first.
//
// This reads the format itself, because minizip 1.1 misreads the sizes of ZIP64 entries, which OpenSCAD and other
// programs write into every 3MF file.
class ZipFile {
public:
    // Throws InputError, which begins with `name`, if `bytes` are not a ZIP archive, or if it has an encrypted entry, two
    // entries with the same normal name, or a name that leads out of it. `bytes` must outlive the object.
    ZipFile(const std::string& name, std::string_view bytes);

    // The entries that are not folders: normal names, and the names in the archive.
    const std::map<std::string, std::string>& names() const { return names_; }

    bool has(std::string_view path) const { return names_.contains(normal_part_name(path)); }

    // Returns an entry, inflated. Throws InputError if there is none, if its bytes are damaged, or if all entries read so
    // far are larger than a sound archive of this size can hold. That is checked before memory is allocated.
    std::string read(std::string_view path);

private:
    struct Entry {
        std::uint64_t method, crc, packed, size, header;  // sizes in bytes; `header`: where its local header lies
    };

    void read_directory(std::uint64_t at, std::uint64_t end, std::uint64_t count);

    std::string name_;
    std::string_view bytes_;
    std::map<std::string, std::string> names_;
    std::map<std::string, Entry> entries_;
    std::uint64_t budget_;  // bytes that may still be inflated
};

}  // namespace hausbench::readers
