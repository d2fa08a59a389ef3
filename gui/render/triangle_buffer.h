// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "gui/render/gl_functions.h"

namespace calot::gui {

/// Vertices of one kind and triangles of them, on the graphics side. Kept from picture to picture.
class TriangleBuffer {
 public:
  /// A vertex shader's input: its location is its place in the list.
  struct Attribute {
    GLint floats;
    std::size_t offset;  ///< in a vertex (bytes)
  };
  /// @param stride size of a vertex (bytes)
  /// @pre the context of `gl` is current, here and in every call; `gl` outlives this
  TriangleBuffer(const GlFunctions& gl, std::size_t stride, std::initializer_list<Attribute> attributes);
  ~TriangleBuffer();
  TriangleBuffer(const TriangleBuffer&) = delete;
  TriangleBuffer& operator=(const TriangleBuffer&) = delete;

  /// @param list has `vertex` and `index`
  template <class List>
  void upload(const List& list) const {
    upload(list.vertex.data(), list.vertex.size() * sizeof(list.vertex[0]), list.index);
  }
  /// Triangles by their indices, with the program, target and settings of the moment.
  void draw(std::size_t firstIndex, std::size_t indexCount) const;

 private:
  void upload(const void* vertices, std::size_t bytes, const std::vector<std::uint32_t>& index) const;

  const GlFunctions& gl_;
  GLuint vertexArray_ = 0, vertexBuffer_ = 0, indexBuffer_ = 0;
};

}  // namespace calot::gui
