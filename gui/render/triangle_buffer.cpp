// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/triangle_buffer.h"

namespace calot::gui {

TriangleBuffer::TriangleBuffer(const GlFunctions& gl, std::size_t stride, std::initializer_list<Attribute> attributes)
    : gl_(gl) {
  gl_.GenVertexArrays(1, &vertexArray_);
  gl_.GenBuffers(1, &vertexBuffer_);
  gl_.GenBuffers(1, &indexBuffer_);
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, indexBuffer_);
  GLuint location = 0;
  for (const Attribute& attribute : attributes) {
    gl_.EnableVertexAttribArray(location);
    gl_.VertexAttribPointer(location++, attribute.floats, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                            reinterpret_cast<const void*>(attribute.offset));
  }
}

TriangleBuffer::~TriangleBuffer() {
  gl_.DeleteBuffers(1, &vertexBuffer_);
  gl_.DeleteBuffers(1, &indexBuffer_);
  gl_.DeleteVertexArrays(1, &vertexArray_);
}

void TriangleBuffer::upload(const void* vertices, std::size_t bytes, const std::vector<std::uint32_t>& index) const {
  gl_.BindVertexArray(vertexArray_);
  gl_.BindBuffer(GL_ARRAY_BUFFER, vertexBuffer_);
  gl_.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(bytes), vertices, GL_STREAM_DRAW);
  gl_.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(index.size() * sizeof(std::uint32_t)), index.data(),
                 GL_STREAM_DRAW);
}

void TriangleBuffer::draw(std::size_t firstIndex, std::size_t indexCount) const {
  gl_.BindVertexArray(vertexArray_);
  gl_.DrawElements(GL_TRIANGLES, static_cast<GLsizei>(indexCount), GL_UNSIGNED_INT,
                   reinterpret_cast<const void*>(firstIndex * sizeof(std::uint32_t)));
}

}  // namespace calot::gui
